#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# check_page.sh SANDRUNNER FOLDER: has the packages of package-lock.json installed in FOLDER, lets
# SANDRUNNER write run.html there and looks at it in Chromium, with WebGL and without. Exit code 77,
# with a line that says why: skipped.
set -euo pipefail

sandrunner=$1
folder=$2
source "$(dirname -- "${BASH_SOURCE[0]}")/prepare.sh"
prepare "the look at run.html" "$folder"
"$sandrunner" --duration 4 --command 1.5,0,0.3 --out "$folder/run" >"$folder/sandrunner.log" || { cat "$folder/sandrunner.log"; exit 1; }
node "$folder/check_page.mjs" "$browser" "$folder/run"
