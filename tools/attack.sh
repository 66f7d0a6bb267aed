#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/attack.sh [--minutes M] [--inputs N] [--seed S] [--only I] [--out DIR]: builds the programs and attacks them
# with random bad inputs, until M minutes or N inputs have passed; --only repeats input I of a seed. Ends with 1 if one
# of them hurt. tools/attack/campaign.py says what is tried and judged.
set -euo pipefail

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
bash "$root/tools/build.sh"
exec python3 "$root/tools/attack/campaign.py" --bin "$root/build/release/bin" "$@"
