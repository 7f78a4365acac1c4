# SPDX-License-Identifier: MIT
# shellcheck shell=bash disable=SC2154 # jobs and logs are those of .ci/test
# clang-tidy on the C++ files that differ from the base. Sourced by .ci/test.

tidy_most_files=10
tidy_seconds=${SHEAF_CI_TIDY_SECONDS:-300}

change_base() { # empty where there is nothing to compare with
  local base=${SHEAF_CI_BASE:-}
  [[ -n $base ]] || base=$(git merge-base HEAD origin/main 2>/dev/null || true)
  if [[ -z $base || $base == "$(git rev-parse HEAD)" ]]; then
    base=$(git rev-parse --verify --quiet HEAD~1 || true)
  fi
  printf '%s' "$base"
}

tidy_changed() {
  local base files file begun=$SECONDS left
  base=$(change_base)
  [[ -n $base ]] || { echo "no earlier commit to compare with"; return 0; }
  mapfile -t files < <(git diff --name-only --diff-filter=d "$base" -- 'engine/*.cpp' 'server/*.cpp' 'tests/*.cpp' |
    head -n "$tidy_most_files")
  ((${#files[@]})) || { echo "no C++ file changed since ${base:0:8}"; return 0; }
  # A precompiled header is the compiler's own: clang-tidy cannot read it.
  quietly tidy-configure cmake -G Ninja -B build/tidy -S . -DCMAKE_BUILD_TYPE=Release -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON \
    -DBUILD_TESTING=ON -Wno-dev
  for file in "${files[@]}"; do
    left=$((tidy_seconds - (SECONDS - begun)))
    ((left > 0)) || { echo "$file: not checked, $tidy_seconds s are over"; continue; }
    tidy_file "$file" "$left"
  done
}

tidy_file() { # FILE SECONDS
  local code=0
  grep -q "\"file\": \"$PWD/$1\"" build/tidy/compile_commands.json || { echo "$1: not built here"; return 0; }
  timeout "$2" clang-tidy --quiet --extra-arg=-Wno-unknown-warning-option -p build/tidy "$1" \
    >"$logs/tidy.log" 2>"$logs/tidy-errors.log" || code=$?
  if ((code == 0)); then
    echo "$1: clean"
  elif ((code == 124)); then
    echo "$1: not checked, time is over"
  elif grep -E ' error: ' "$logs/tidy.log" | grep -qv 'clang-diagnostic-error'; then
    cat "$logs/tidy.log"
    return 1
  elif grep -q 'clang-diagnostic-error' "$logs/tidy.log"; then
    # An older clang does not compile all of C++20 that GCC does, and GCC has compiled this with warnings as errors.
    echo "$1: not checked, $(clang-tidy --version | grep -o 'version [0-9]*') cannot compile it"
  else
    cat "$logs/tidy-errors.log"
    return 1
  fi
}
