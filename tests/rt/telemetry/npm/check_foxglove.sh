#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# check_foxglove.sh SANDRUNNER FOLDER: has the packages of package-lock.json installed in FOLDER and
# lets Foxglove's own client look at a run of SANDRUNNER. Exit code 77, with a line that says why:
# skipped.
set -euo pipefail

sandrunner=$1
folder=$2
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
source "$here/../npm_packages.sh"
npm_packages "the check of live topics by Foxglove's client" "$here" "$folder"
cp "$here"/*.mjs "$folder/"
node "$folder/check_foxglove.mjs" "$sandrunner" "$folder"
