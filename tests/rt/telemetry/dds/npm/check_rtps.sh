#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# check_rtps.sh DDS_PEER FOLDER: has the packages of package-lock.json installed in FOLDER and lets
# @foxglove/rtps receive what DDS_PEER publishes. Exit code 77, with a line that says why: skipped.
set -euo pipefail

peer=$1
folder=$2
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)

source "$here/../../npm_packages.sh"
npm_packages "the check of the ROS topics by @foxglove/rtps" "$here" "$folder"
cp "$here/check_rtps.mjs" "$folder/"
node "$folder/check_rtps.mjs" "$peer"
