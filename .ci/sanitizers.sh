# SPDX-License-Identifier: MIT
# shellcheck shell=bash disable=SC2154 # jobs, logs and venv are those of .ci/test
# Unit tests, and the service under its own tests, built with sanitizers. Sourced by .ci/test.

sanitizer_build_seconds=${SHEAF_CI_SANITIZER_SECONDS:-900} # a build; with a warm compiler cache it takes seconds

sanitized_tests() { # PRESET SUBJECT...
  local preset=$1 subjects code=0
  shift
  subjects=$(IFS=';'; printf '%s' "$*")
  quietly "$preset-configure" cmake --preset "$preset" -DBUILD_TESTING=ON "-DSHEAF_TEST_SUBJECTS=$subjects" -Wno-dev
  quietly "$preset-build" timeout "$sanitizer_build_seconds" \
    cmake --build --preset "$preset" --target unit_tests sheafd --parallel "$jobs" || code=$?
  if ((code == 124)); then
    echo "NOT RUN: the build took over $sanitizer_build_seconds s; run .ci/test again, it goes on from there"
    return 0
  fi
  ((code == 0)) || return "$code"
  sanitized "$preset-ctest" ctest --preset "$preset" --parallel "$jobs" --timeout 600 --no-tests=error
  SHEAF_BUILD=$PWD/build-$preset sanitized "$preset-service" \
    "$venv/bin/pytest" -q -p no:cacheprovider tests/service
}

sanitized() { # LOG COMMAND...
  local log=$1 same_addresses=()
  shift
  # ThreadSanitizer of GCC 12 dies of addresses as random as newer kernels make them.
  if [[ $log == tsan* ]] && setarch -R true 2>/dev/null; then same_addresses=(setarch -R); fi
  UBSAN_OPTIONS=print_stacktrace=1 TSAN_OPTIONS=halt_on_error=1 quietly "$log" "${same_addresses[@]}" "$@"
  grep -E 'tests passed|[0-9]+ passed' "$logs/$log.log" | sed "s/^/$log: /"
}
