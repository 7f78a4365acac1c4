# SPDX-License-Identifier: MIT
# shellcheck shell=bash disable=SC2034 # used by those that source it
# What the scripts of .ci share. Sourced in the root of the checkout.
jobs=$(nproc)
logs=build/ci
venv=build/venv
step='' step_begun=$SECONDS
failed=() flaky=()

quietly() { # LOG COMMAND...: the log is shown only if the command fails
  local log=$logs/$1.log code=0
  shift
  "$@" >"$log" 2>&1 || code=$?
  ((code == 0)) || tail -n 200 "$log"
  return "$code"
}

headline() { # names the step that begins, and says what the last one took
  [[ -z $step ]] || printf '   %s: %d s\n' "$step" $((SECONDS - step_begun))
  step=$1 step_begun=$SECONDS
  printf '\n== %s (%d s so far)\n' "$step" "$SECONDS"
}

prepare() { # packages and the Python environment
  trap 'code=$?; ((code == 0)) || printf "\n%s: FAILED in: %s (%d s so far)\n" "$0" "${step:-start}" "$SECONDS" >&2' EXIT
  mkdir -p "$logs"
  touch "$logs/begun"
  export SHEAF_BUILD=$PWD/build

  headline "packages"
  SHEAF_CI_EXTRAS=${SHEAF_CI_EXTRAS:-1} .ci/setup
  # What is there must be used: a test that is left out all the same is a failure.
  if command -v chromium >/dev/null && command -v slurmctld >/dev/null && command -v munged >/dev/null; then
    export SHEAF_REQUIRE_TOOLS=1
  fi

  headline "python environment"
  stamp=$(sha256sum client/pyproject.toml .ci/requirements.txt .ci/optional.txt | sha256sum)
  if [[ ! -x $venv/bin/pytest || $(cat "$venv/stamp" 2>/dev/null) != "$stamp" ]]; then
    python3 -m venv --clear "$venv"
    quietly pip "$venv/bin/pip" install --disable-pip-version-check -e './client[dev]' -r .ci/requirements.txt
    "$venv/bin/pip" install -q --disable-pip-version-check -r .ci/optional.txt || echo "without some of .ci/optional.txt"
    printf '%s\n' "$stamp" >"$venv/stamp"
  fi
  "$venv/bin/python" --version
}

build_release() {
  headline "build"
  quietly configure cmake --preset release -DBUILD_TESTING=ON -USHEAF_TEST_SUBJECTS -Wno-dev
  cmake --build --preset release --parallel "$jobs"
}

# After a failure of these the others still run: `failed` keeps its name.
tests_of() { # PATH...: what fails runs once more by itself; what passes then is flaky, is counted and named at the end
  local name=${1//\//-} run log
  run=("$venv/bin/pytest" -q -rfEs --timeout 600 -o "cache_dir=$PWD/$logs/cache-$name")
  log=$logs/pytest-$name.log
  headline "pytest $1"
  "${run[@]}" "$@" 2>&1 | tee "$log" && return
  printf '\n-- once more, what failed\n'
  if "${run[@]}" --last-failed --last-failed-no-failures none "$@" 2>&1 | tee "$logs/pytest-$name-again.log"; then
    mapfile -t -O "${#flaky[@]}" flaky < <(sed -nE 's/^(FAILED|ERROR) ([^ ]+).*/\2/p' "$log" | sort -u)
  else
    failed+=("pytest $1")
  fi
}

decide() { # NAME COMMAND...
  local code=0
  headline "$1"
  "${@:2}" || code=$?
  ((code == 0)) || failed+=("$1")
}

close() { # the closing lines, and the exit code
  headline "closing lines"
  local log
  for log in "$logs"/ctest.log "$logs"/pytest-*.log; do
    [[ $log == *-again.log || $log -ot $logs/begun ]] && continue
    printf '%s: %s\n' "$(basename "$log" .log)" "$(grep -E 'tests passed|tests failed|[0-9]+ (passed|failed)' "$log" | tail -n 1)"
  done
  printf 'flaky: %d tests passed only when they ran again\n' "${#flaky[@]}"
  ((${#flaky[@]} == 0)) || printf '  %s\n' "${flaky[@]}"
  ((${#failed[@]} == 0)) && return
  step=$(IFS=,; printf '%s' "${failed[*]}")
  exit 1
}
