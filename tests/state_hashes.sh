#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tests/state_hashes.sh BIN OTHERS [EMULATOR]: the programs in BIN, run by EMULATOR, end in the
# states of golden/state_hashes.txt, as on every system, processor and compiler; and the programs in
# BIN and those in OTHERS, which are run as they are, replay each other's recordings bit for bit.
# Ends with 77 if OTHERS lacks the programs: tests then skip.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

golden=$(dirname -- "${BASH_SOURCE[0]}")/golden/state_hashes.txt
bin=$1 others=$2 emulator=${3:-}
if [[ ! -x $others/sandrunner || ! -x $others/sandrunner-replay ]]; then
  echo "skipped: found no sandrunner and sandrunner-replay in $others: tools/build.sh builds them"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
differ=0
# Runs the words; if it fails, shows what it printed last.
run() {
  "$@" >"$folder/log" 2>&1 </dev/null && return
  echo "$*: ended with exit code $?:" >&2
  tail -n 5 "$folder/log" >&2
  differ=1
}

while read -r expected arguments; do
  # shellcheck disable=SC2086  # words of a command line
  run $emulator "$bin/sandrunner" $arguments
  found=$(sed -n 's/^ *state hash *//p' "$folder/log")
  [[ $found == "$expected" ]] && continue
  echo "sandrunner $arguments: found state hash '$found', expected $expected" >&2
  differ=1
done <"$golden"

# shellcheck disable=SC2086
run $emulator "$bin/sandrunner" --start walk --duration 2 --record "$folder/ours"
run "$others/sandrunner" --start walk --duration 2 --record "$folder/theirs"
run "$others/sandrunner-replay" "$folder/ours/run.mcap"
# shellcheck disable=SC2086
run $emulator "$bin/sandrunner-replay" "$folder/theirs/run.mcap"
exit $differ
