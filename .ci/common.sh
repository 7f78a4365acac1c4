# SPDX-License-Identifier: MIT
# shellcheck shell=bash disable=SC2034 # used by those that source it
# What the scripts of .ci/test share. Sourced in the root of the checkout.
jobs=$(nproc)
logs=build/ci
venv=build/venv

quietly() { # LOG COMMAND...: the log is shown only if the command fails
  local log=$logs/$1.log code=0
  shift
  "$@" >"$log" 2>&1 || code=$?
  ((code == 0)) || tail -n 200 "$log"
  return "$code"
}
