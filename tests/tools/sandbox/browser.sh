#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# browser.sh SANDBOX FOLDER: has the packages of the view's package-lock.json installed in FOLDER,
# lets SANDBOX write a page there and drives its robot in Chromium. Exit code 77, with a line that
# says why: skipped.
set -euo pipefail

here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
source "$here/../../rt/telemetry/view/npm/prepare.sh"
prepare "the look at a sandbox" "$2"
cp "$here/check_sandbox.mjs" "$2/"
"$1" --out "$2/sandbox.html" >"$2/sandbox.log" || { cat "$2/sandbox.log"; exit 1; }
node "$2/check_sandbox.mjs" "$browser" "$2/sandbox.html"
