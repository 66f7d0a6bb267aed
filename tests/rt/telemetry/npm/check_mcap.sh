#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# check_mcap.sh MCAP_SAMPLE SANDRUNNER FOLDER: has the packages of package-lock.json installed in
# FOLDER and lets @mcap/core read what MCAP_SAMPLE writes and what SANDRUNNER records. Exit code 77,
# with a line that says why: skipped.
set -euo pipefail

sample=$1
sandrunner=$2
folder=$3
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
messages=20000

source "$here/../npm_packages.sh"
npm_packages "the check of MCAP files by @mcap/core" "$here" "$folder"
cp "$here"/*.mjs "$folder/"
"$sample" "$folder/sample.mcap" "$messages"
node "$folder/check_mcap.mjs" "$folder/sample.mcap" "$messages"
"$sandrunner" --start walk --duration 2 --record "$folder" >"$folder/sandrunner.log" || { cat "$folder/sandrunner.log"; exit 1; }
node "$folder/check_recording.mjs" "$folder/run.mcap" 8000
