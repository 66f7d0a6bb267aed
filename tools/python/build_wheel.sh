#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/python/build_wheel.sh [FOLDER]: installs missing packages (sudo apt-get), builds the Python
# module into build/release and packs it as a wheel into FOLDER (default: build/release/wheel). The
# wheel holds robots, terrain presets and the shipped policy, and needs numpy alone.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
folder=${1:-$root/build/release/wheel}
bash "$root/tools/python/build.sh"
version=$(sed -n 's/^CMAKE_PROJECT_VERSION:STATIC=//p' "$root/build/release/CMakeCache.txt")
/usr/bin/python3 "$root/tools/python/make_wheel.py" "$root/build/release/python/sandrunner" "$version" "$folder"
