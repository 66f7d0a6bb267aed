#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/build.sh [--arm64] [sandrunner|deb|python_module]: installs missing packages (sudo apt-get)
# and builds in release, into build/release.
#   (without)      everything
#   sandrunner     the program sandrunner only: half the packages and a fifth of the time
#   deb            the Debian package for a robot's computer (tools/deploy)
#   python_module  the Python module and what its tests need (tools/python)
#   --arm64        for 64-bit ARM, on an x86-64 machine, into build/arm64
# Reports on stderr; prints nothing if nothing is to be done.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
preset=release what=all
for word; do
  case $word in
    --arm64) preset=arm64 ;;
    sandrunner | deb | python_module) what=$word ;;
    *) echo "build.sh: found '$word', expected --arm64, sandrunner, deb or python_module" >&2 && exit 2 ;;
  esac
done
build=$root/build/$preset
bash "$root/tools/install_packages.sh" "$what"
[[ $preset != arm64 ]] || bash "$root/tools/install_packages.sh" arm64

# Configured for this very folder (a copied tree brings the build of its original along), and for
# all that is asked for?
cached() { grep -qsxF "$1" "$build/CMakeCache.txt"; }
configure=(cmake --preset "$preset")
[[ $what != sandrunner ]] || configure+=(-D SANDRUNNER_ALL=OFF)
complete() { cached SANDRUNNER_ALL:BOOL=ON && { [[ $preset == arm64 ]] || cached SANDRUNNER_PYTHON:BOOL=ON; }; }
if [[ ! -f $build/build.ninja ]] || ! cached "CMAKE_HOME_DIRECTORY:INTERNAL=$root"; then
  (cd "$root" && "${configure[@]}" --fresh) >&2
elif [[ $what != sandrunner ]] && ! complete; then
  (cd "$root" && "${configure[@]}") >&2
fi
# What ninja says when nothing is to be done. Asked with -n, it does not know: it would look for new
# files first.
idle='^ninja: no work to do\.$|Re-checking globbed directories\.\.\.$'
cmake --build "$build" --target "$what" 2>&1 | { grep --line-buffered -vE "$idle" || true; } >&2
