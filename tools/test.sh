#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/test.sh [arguments]: installs what is missing, builds everything in release, runs all tests. Arguments go
# to ctest (tools/test.sh -R Config).
set -euo pipefail

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/release
bash "$root/tools/install_packages.sh"

# Configured, and for this very folder (a copied tree brings the build of its original along)?
if [[ ! -f $build/build.ninja ]] ||
  ! grep -qsxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$build/CMakeCache.txt"; then
  (cd "$root" && cmake --fresh --preset release)
fi
cmake --build "$build"
cd "$root"
exec ctest --preset release -j2 "$@"
