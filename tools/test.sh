#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/test.sh [arguments]: installs what is missing, builds, and runs all tests. Arguments go to ctest
# (tools/test.sh -R Config). Ends with the tests that were skipped and why, and with the exit code of ctest.
set -euo pipefail

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
