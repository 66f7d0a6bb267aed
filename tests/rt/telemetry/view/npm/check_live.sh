#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# check_live.sh SANDRUNNER FOLDER: has the packages of package-lock.json installed in FOLDER and looks at runs of SANDRUNNER
# while they go, in Chromium. Exit code 77, with a line that says why: skipped.
set -euo pipefail

sandrunner=$1
folder=$2
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)

browser=
for name in chromium-headless-shell chromium google-chrome; do
  browser=$(command -v "$name") && break
done
[[ -n $browser ]] || { echo "SKIPPED: the look at a live run needs Debian's chromium-headless-shell, which is not installed"; exit 77; }
source "$here/../../npm_packages.sh"
npm_packages "the look at a live run" "$here" "$folder"
cp "$here"/*.mjs "$folder/"
"$sandrunner" --duration 2 --record "$folder/recording" >"$folder/recording.log" || { cat "$folder/recording.log"; exit 1; }
node "$folder/check_live.mjs" "$browser" "$sandrunner" "$folder/recording/run.mcap"
