#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# seams.sh ROOT COMPILER [FLAGS...]: compiles what the sandbox's module is made of for this machine,
# without exceptions, a folder at a time, and requires that it includes no library. So a source that
# closes a seam is found where no packages for WebAssembly are.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

root=$1
shift
temporary=$(mktemp -d)
trap 'rm -rf -- "$temporary"' EXIT
cd -- "$root"
# module.cpp is for WebAssembly alone.
sources=$(grep -v /module.cpp tools/sandbox/sources.txt)
failed=0
for folder in $(xargs -n 1 dirname <<<"$sources" | sort -u); do
  grep "^$folder/[^/]*$" <<<"$sources" | sed 's/.*/#include "&"/' >"$temporary/folder.cpp"
  if ! "$@" -std=c++20 -w -fno-exceptions -fsyntax-only -I . -MD -MF "$temporary/found" "$temporary/folder.cpp"; then
    echo "$folder: found what does not compile without exceptions, expected sources of tools/sandbox/sources.txt that do" >&2
    failed=1
  elif grep -E '/(fmt|toml\+\+|nlohmann|CLI|spdlog)/' "$temporary/found" >&2; then
    echo "$folder: found a library, expected sources of tools/sandbox/sources.txt without one" >&2
    failed=1
  fi
done
exit "$failed"
