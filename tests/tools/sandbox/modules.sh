#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# modules.sh SANDRUNNER SANDBOX POLICIES FOLDER: compares the modules of sandbox pages, in node,
# with SANDRUNNER, also with what POLICIES writes. Exit code 77, with a line that says why: skipped.
set -euo pipefail

command -v node >/dev/null || { echo "SKIPPED: the modules need node 20, which is not installed"; exit 77; }
mkdir -p "$4"
"$3" "$4"
node "$(dirname -- "${BASH_SOURCE[0]}")/check_modules.mjs" "$1" "$2" "$4"
