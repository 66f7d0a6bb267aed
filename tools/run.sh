#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/run.sh [OPTION...]: installs missing packages (sudo apt-get), builds, and runs sandrunner
# with the options in the current folder. Only the program writes to stdout. --help lists the
# options once the program is built.
set -euo pipefail

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
program=$root/build/release/bin/sandrunner
for word; do
  case $word in -h | --help)
    sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0"
    [[ ! -x $program ]] || exec "$program" --help
    exit
    ;;
  esac
done
bash "$root/tools/build.sh" sandrunner
exec "$program" "$@"
