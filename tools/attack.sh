#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/attack.sh [--minutes M] [--inputs N] [--seed S] [--only I] [--out DIR]: builds the programs
# and attacks them with random bad inputs, until M minutes or N inputs have passed. --only repeats
# input I of a seed. Exits with 1 if an input broke a program. tools/attack/campaign.py describes
# the inputs and the verdicts.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
bash "$root/tools/build.sh"
exec python3 "$root/tools/attack/campaign.py" --bin "$root/build/release/bin" "$@"
