#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the Debian packages that the build, the programs and the tests need and that are missing. If none is
# missing it only asks dpkg: no network, no rights, a fraction of a second.
set -euo pipefail

packages=(
  # tools; fonts-dejavu-core is what the pictures are lettered with
  g++ cmake ninja-build pkg-config git fonts-dejavu-core
  # libraries of the programs
  libeigen3-dev libtomlplusplus-dev nlohmann-json3-dev libcli11-dev libfmt-dev
  liburdfdom-dev libcairo2-dev cyclonedds-dev cyclonedds-tools libzstd-dev zlib1g-dev
  # libraries of tests and benches
  libgtest-dev libgmock-dev libmujoco-dev rt-tests openssl python3-numpy
  libfastrtps-dev libfastcdr-dev fastddsgen default-jre-headless
)

fail() {
  echo "install_packages.sh: $1" >&2
  exit 1
}

for tool in dpkg-query apt-get; do
  command -v "$tool" >/dev/null ||
    fail "found no $tool, expected Debian 12; the packages needed are: ${packages[*]}"
done

installed=$(dpkg-query --show --showformat='${db:Status-Status} ${Package}\n' \
  "${packages[@]}" 2>/dev/null | sed -n 's/^installed //p') || true
missing=()
for package in "${packages[@]}"; do
  grep -qxF -- "$package" <<<"$installed" || missing+=("$package")
done
((${#missing[@]})) || exit 0

as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null ||
    fail "neither root nor sudo here, have an administrator run: apt-get install ${missing[*]}"
  as_root=(sudo)
fi
echo "installing Debian packages: ${missing[*]}" >&2
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0)
"${apt[@]}" update >&2 || fail "apt-get update failed, see above"
"${apt[@]}" install --yes --no-install-recommends "${missing[@]}" >&2 ||
  fail "apt-get could not install: ${missing[*]}"
