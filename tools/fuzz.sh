#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/fuzz.sh TIME [NAME...]: builds the libFuzzer programs in build/asan-ubsan and runs each of
# them, or only NAME..., for TIME (10m, 20s), one on each processor. The corpus is kept in
# build/fuzz/corpus/NAME. Exits with 1 at the first finding, which is in build/fuzz/findings.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
if ! [[ ${1:-} =~ ^([1-9][0-9]{0,5})([ms])$ ]]; then
  echo "fuzz.sh: found '${1:-}', expected a time such as 10m or 20s" >&2
  exit 2
fi
seconds=${BASH_REMATCH[1]}
[[ ${BASH_REMATCH[2]} == s ]] || seconds=$((60 * seconds))
shift

bash "$root/tools/install_packages.sh" checks
cd "$root"
cmake --preset asan-ubsan -D SANDRUNNER_FUZZ=ON >&2
cmake --build build/asan-ubsan --target "${@:-fuzz}" >&2
(($#)) || set -- $(cd build/asan-ubsan/bin && echo *_fuzz)
mkdir -p build/fuzz/findings
# A program may hold a source twice, its own and the library's (tests/CMakeLists.txt).
export ASAN_OPTIONS=detect_odr_violation=0${ASAN_OPTIONS:+:$ASAN_OPTIONS}
# As many at once as there are processors. 255: xargs starts no more of them.
printf '%s\0' "$@" | xargs -0 -n 1 -P "$(nproc)" bash -c '
  mkdir -p "build/fuzz/corpus/$1"
  echo "== $1" >&2
  "build/asan-ubsan/bin/$1" -max_total_time="$0" -max_len=16384 -artifact_prefix="build/fuzz/findings/$1-" \
    -verbosity=0 -print_final_stats=1 "build/fuzz/corpus/$1" || exit 255' "$seconds" || exit 1
