#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/test.sh [OPTION...]: installs missing packages (sudo apt-get), builds, and runs all tests.
# Options go to ctest (tools/test.sh -R Config). Prints the skipped tests with their reasons at the
# end; exits with the code of ctest.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
bash "$root/tools/install_packages.sh" test
bash "$root/tools/build.sh"
cd "$root"
results=build/release/Testing/results.xml
rm -f "$results"
code=0
ctest --preset release -j2 --output-junit "$root/$results" --test-output-size-passed 1000000 "$@" || code=$?
[[ ! -e $results ]] || /usr/bin/python3 tools/skipped_tests.py "$results"
exit "$code"
