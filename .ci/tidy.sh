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
  local base files
  base=$(change_base)
  [[ -n $base ]] || { echo "no earlier commit to compare with"; return 0; }
  mapfile -t files < <(git diff --name-only --diff-filter=d "$base" -- 'engine/*.cpp' 'server/*.cpp' 'tests/*.cpp' |
    head -n "$tidy_most_files")
  ((${#files[@]})) || { echo "no C++ file changed since ${base:0:8}"; return 0; }
  # A precompiled header is the compiler's own: clang-tidy cannot read it.
  quietly tidy-configure cmake -G Ninja -B build/tidy -S . -DCMAKE_BUILD_TYPE=Release -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON \
    -DBUILD_TESTING=ON -Wno-dev
  export logs deadline=$((EPOCHSECONDS + tidy_seconds))
  export -f tidy_file
  # shellcheck disable=SC2016 # the inner shell expands it
  printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$jobs" bash -c 'tidy_file "$1"' -
}

tidy_file() { # runs in a shell of its own
  local code=124 left=$((deadline - EPOCHSECONDS)) log=$logs/tidy-${1//\//_}
  grep -q "\"file\": \"$PWD/$1\"" build/tidy/compile_commands.json || { echo "$1: not built here"; return 0; }
  if ((left > 0)); then
    code=0
    timeout "$left" clang-tidy --quiet --extra-arg=-Wno-unknown-warning-option -p build/tidy "$1" \
      >"$log" 2>"$log.errors" || code=$?
  fi
  if ((code == 0)); then
    echo "$1: clean"
  elif ((code == 124)); then
    echo "$1: not checked, time is over"
  elif grep -E ' error: ' "$log" | grep -qv 'clang-diagnostic-error'; then
    cat "$log"
    return 1
  elif grep -q 'clang-diagnostic-error' "$log"; then
    # An older clang does not compile all of C++20 that GCC does, and GCC has compiled this with warnings as errors.
    echo "$1: not checked, $(clang-tidy --version | grep -o 'version [0-9]*') cannot compile it"
  else
    cat "$log.errors"
    return 1
  fi
}
