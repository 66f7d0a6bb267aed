#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/python/build.sh: installs missing packages (sudo apt-get) and builds the Python module and
# what its tests need, and no more, into build/release. PYTHONPATH=build/release/python then finds
# the package. Reports on stderr.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
bash "$root/tools/build.sh" python_module
