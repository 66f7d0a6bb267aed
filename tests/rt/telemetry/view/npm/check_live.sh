#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# check_live.sh SANDRUNNER FOLDER: has the packages of package-lock.json installed in FOLDER and looks at runs of SANDRUNNER
# while they go, in Chromium. Exit code 77, with a line that says why: skipped.
set -euo pipefail

sandrunner=$1
folder=$2
source "$(dirname -- "${BASH_SOURCE[0]}")/prepare.sh"
prepare "the look at a live run" "$folder"
"$sandrunner" --duration 2 --record "$folder/recording" >"$folder/recording.log" || { cat "$folder/recording.log"; exit 1; }
node "$folder/check_live.mjs" "$browser" "$sandrunner" "$folder/recording/run.mcap"
