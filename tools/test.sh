#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/test.sh [arguments]: installs what is missing, builds, and runs all tests. Arguments go to ctest
# (tools/test.sh -R Config).
set -euo pipefail

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
bash "$root/tools/build.sh"
cd "$root"
exec ctest --preset release -j2 "$@"
