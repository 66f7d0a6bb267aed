#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tests/state_hashes.sh BIN OTHERS [EMULATOR]: the programs in BIN, run by EMULATOR, end in the
# states of golden/state_hashes.txt, as on every system, processor and compiler; and the programs in
# BIN and those in OTHERS, which are run as they are, replay each other's recordings bit for bit.
set -euo pipefail
golden=$(dirname -- "${BASH_SOURCE[0]}")/golden/state_hashes.txt
bin=$1 others=$2 emulator=${3:-}
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT

differ=0
while read -r expected arguments; do
  # shellcheck disable=SC2086  # words of a command line
  found=$($emulator "$bin/sandrunner" $arguments 2>&1 </dev/null | sed -n 's/^ *state hash *//p')
  [[ $found == "$expected" ]] && continue
  echo "sandrunner $arguments: found state hash '$found', expected $expected" >&2
  differ=1
done <"$golden"

$emulator "$bin/sandrunner" --start walk --duration 2 --record "$folder/ours" >/dev/null 2>&1
"$others/sandrunner" --start walk --duration 2 --record "$folder/theirs" >/dev/null 2>&1
"$others/sandrunner-replay" "$folder/ours/run.mcap" || differ=1
$emulator "$bin/sandrunner-replay" "$folder/theirs/run.mcap" || differ=1
exit $differ
