#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# check_rtps.sh DDS_PEER FOLDER: has the packages of package-lock.json installed in FOLDER and lets @foxglove/rtps receive
# what DDS_PEER publishes. Exit code 77, with a line that says why: skipped.
set -euo pipefail

peer=$1
folder=$2
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)

skip() {
  echo "SKIPPED: the check of the ROS topics by @foxglove/rtps needs $1"
  exit 77
}

command -v node >/dev/null && command -v npm >/dev/null || skip "node and npm, which are not installed"
mkdir -p "$folder"
# The stamp is written last, so that a broken installation is done again.
if ! cmp -s "$here/package-lock.json" "$folder/installed.json"; then
  cp "$here/package.json" "$here/package-lock.json" "$folder/"
  if ! (cd "$folder" && npm ci --ignore-scripts --no-audit --no-fund --fetch-retries=1 --fetch-timeout=20000 \
      >npm.log 2>&1); then
    npm ping --fetch-retries=0 --fetch-timeout=5000 >/dev/null 2>&1 || skip "the npm registry, which does not answer"
    cat "$folder/npm.log"
    exit 1
  fi
  cp "$here/package-lock.json" "$folder/installed.json"
fi
cp "$here/check_rtps.mjs" "$folder/"
node "$folder/check_rtps.mjs" "$peer"
