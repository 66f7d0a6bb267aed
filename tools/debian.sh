#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/debian.sh SUITE [COMMAND...]: runs COMMAND, or else tools/test.sh, on this work tree in a
# Debian of its own: SUITE is bookworm (12) or trixie (13). Its root is made by debootstrap and
# kept, with packages and build, in ~/.cache/sandrunner/SUITE (5 GB). What git ignores does not come
# along. As root. Reports on stderr.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

fail() {
  echo "debian.sh: $1" >&2
  exit 2
}
suite=${1:-}
[[ $suite == @(bookworm|trixie) ]] || fail "found suite '$suite', expected bookworm or trixie"
((EUID == 0)) || fail "expected to run as root: it makes and enters a root directory"
command -v debootstrap >/dev/null || fail "found no debootstrap (Debian package of that name)"
shift
(($#)) || set -- tools/test.sh

cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
root=${XDG_CACHE_HOME:-$HOME/.cache}/sandrunner/$suite
if [[ ! -e $root ]]; then
  rm -rf "$root.new"
  mkdir -p "$root.new"
  debootstrap --variant=minbase "$suite" "$root.new" >&2
  printf '#!/bin/sh\nexit 101\n' >"$root.new/usr/sbin/policy-rc.d" # packages start no services
  chmod +x "$root.new/usr/sbin/policy-rc.d"
  mv "$root.new" "$root"
fi
# The commit, and what differs from it.
[[ -e $root/sandrunner/.git ]] || git clone --quiet --no-checkout "$PWD" "$root/sandrunner"
git -C "$root/sandrunner" fetch --quiet "$PWD" HEAD
git -C "$root/sandrunner" checkout --quiet --force --detach FETCH_HEAD
git -C "$root/sandrunner" clean --quiet --force -d
git diff --binary HEAD | git -C "$root/sandrunner" apply --allow-empty
git ls-files -z --others --exclude-standard | tar -c --null --files-from=- | tar -x -C "$root/sandrunner"
export root
exec unshare --mount --propagation private bash -c '
  mount -t proc proc "$root/proc"
  mount --rbind /sys "$root/sys"
  mount --rbind /dev "$root/dev"
  exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 TERM="${TERM:-dumb}" \
    chroot "$root" sh -c "cd /sandrunner && exec \"\$@\"" sh "$@"' bash "$@"
