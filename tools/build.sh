#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is missing and builds everything in release, into build/release. Says what it does on stderr; says
# nothing if nothing is to be done.
set -euo pipefail

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/release
bash "$root/tools/install_packages.sh"

# Configured, and for this very folder (a copied tree brings the build of its original along)?
if [[ ! -f $build/build.ninja ]] ||
  ! grep -qsxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$build/CMakeCache.txt"; then
  (cd "$root" && cmake --fresh --preset release) >&2
fi
if [[ $(ninja -C "$build" -n) != *"no work to do"* ]]; then
  cmake --build "$build" >&2
fi
