#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/run.sh [OPTION...]: installs missing packages (sudo apt-get), builds, and runs sandrunner
# with the options in the current folder. Only the program writes to stdout. --help lists the
# options once the program is built. After a run with --out, tools/pictures.py draws run.png and
# strip.png there.
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
out= before=
for word; do
  case $before in --out) out=$word ;; esac
  case $word in --out=*) out=${word#--out=} ;; esac
  before=$word
done
[[ $out ]] || exec "$program" "$@"

# A signal to this script reaches the program; the terminal's reach it anyway.
"$program" "$@" <&0 &
child=$!
trap 'kill -TERM "$child" 2>/dev/null' TERM
trap : INT HUP
while true; do
  wait "$child" && code=0 || code=$?
  kill -0 "$child" 2>/dev/null || break  # else a trapped signal ended the wait alone
done
((code == 2)) || /usr/bin/python3 -B "$root/tools/pictures.py" "$out" >&2 || true
exit "$code"
