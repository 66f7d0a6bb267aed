#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# check_live.sh SANDRUNNER FOLDER: has the packages of package-lock.json installed in FOLDER and
# looks at runs of SANDRUNNER while they go, in Chromium. Exit code 77, with a line that says why:
# skipped.
set -euo pipefail

sandrunner=$1
folder=$2
source "$(dirname -- "${BASH_SOURCE[0]}")/prepare.sh"
prepare "the look at a live run" "$folder"
"$sandrunner" --duration 2 --record "$folder/recording" >"$folder/recording.log" || { cat "$folder/recording.log"; exit 1; }
# A fault in real time leaves a black box: two seconds away the robot tilts, as it sinks in; by 9
# degrees it touches with a thigh, which is a fall and no fault.
rm -rf "$folder/faulted"
printf '[[terrain.patch]]\nfrom_x_m = 2.5\nsigma_flat_npm3 = 0.1e6\nsigma_cone_npm3 = 0.02e6\n' >"$folder/pit.toml"
"$sandrunner" --clock realtime --start walk --duration 20 --config "$folder/pit.toml" \
  --set controller.gate.tilt_fault_deg=7.5 --out "$folder/faulted" \
  >"$folder/faulted.log" 2>&1 || [[ $? == 1 ]] || { cat "$folder/faulted.log"; exit 1; }
node "$folder/check_live.mjs" "$browser" "$sandrunner" "$folder/recording/run.mcap" "$folder"/faulted/black-box-*.mcap
