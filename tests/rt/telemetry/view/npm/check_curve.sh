#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# check_curve.sh SANDRUNNER_TRAIN FOLDER: has the packages of package-lock.json installed in FOLDER,
# lets SANDRUNNER_TRAIN train there for a moment and looks at curve.html in Chromium. Exit code 77,
# with a line that says why: skipped.
set -euo pipefail

train=$1
folder=$2
source "$(dirname -- "${BASH_SOURCE[0]}")/prepare.sh"
prepare "the look at curve.html" "$folder"
rm -rf "$folder/training"
"$train" --out "$folder/training" --set run.envs=64 --set run.transitions=12800 --set learner.window=8 \
  --set learner.minibatches=1 >"$folder/train.log" || { cat "$folder/train.log"; exit 1; }
node "$folder/check_curve.mjs" "$browser" "$folder/training"
