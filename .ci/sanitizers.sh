# SPDX-License-Identifier: MIT
# shellcheck shell=bash disable=SC2154 # jobs and logs are those of .ci/test
# Unit tests built with sanitizers. Sourced by .ci/test.

sanitizer_build_seconds=${SHEAF_CI_SANITIZER_SECONDS:-900} # a build; with a warm compiler cache it takes seconds

sanitized_tests() { # PRESET SUBJECT...
  local preset=$1 subjects code=0 same_addresses=()
  shift
  subjects=$(IFS=';'; printf '%s' "$*")
  quietly "$preset-configure" cmake --preset "$preset" -DBUILD_TESTING=ON "-DSHEAF_TEST_SUBJECTS=$subjects" -Wno-dev
  quietly "$preset-build" timeout "$sanitizer_build_seconds" \
    cmake --build --preset "$preset" --target unit_tests --parallel "$jobs" || code=$?
  if ((code == 124)); then
    echo "NOT RUN: the build took over $sanitizer_build_seconds s; run .ci/test again, it goes on from there"
    return 0
  fi
  ((code == 0)) || return "$code"
  # ThreadSanitizer of GCC 12 dies of addresses as random as newer kernels make them.
  if [[ $preset == tsan ]] && setarch -R true 2>/dev/null; then same_addresses=(setarch -R); fi
  UBSAN_OPTIONS=print_stacktrace=1 quietly "$preset" "${same_addresses[@]}" \
    ctest --preset "$preset" --parallel "$jobs" --timeout 600 --no-tests=error
  grep -E 'tests passed|tests failed' "$logs/$preset.log"
}
