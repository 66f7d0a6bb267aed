#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/install_packages.sh [all|sandrunner|deb|test|checks|arm64]: installs the missing Debian
# packages with apt-get, as root or with sudo. If none is missing it only queries dpkg: no network
# and no permissions are needed.
#   all, deb    everything, the Debian package and the Python module included
#   sandrunner  the program sandrunner only
#   test        everything, and what only tests run
#   checks      everything, and the checks of .ci/run
#   arm64       what builds for 64-bit ARM, and runs it, on another machine; beside all
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

packages=(
  g++ cmake ninja-build git
  libtomlplusplus-dev nlohmann-json3-dev libcli11-dev libfmt-dev
  liburdfdom-dev libconsole-bridge-dev libtinyxml2-dev cyclonedds-dev cyclonedds-tools libssl-dev libzstd-dev zlib1g-dev
  esbuild libjs-three libboost-dev
)
# Trainer, benches, tests and the Debian package with its man pages; the emulated machine of
# tools/hil; a DDS peer that is not ours, and the generator of its code; the Python module; the page
# of tools/study and tools/pictures.py.
[[ ${1:-all} == sandrunner ]] || packages+=(
  libeigen3-dev libgtest-dev libgmock-dev libmujoco-dev rt-tests openssl python3-numpy dpkg-dev file help2man
  qemu-system-x86 busybox-static cpio xz-utils zstd
  libfastrtps-dev libfastcdr-dev fastddsgen default-jre-headless
  pybind11-dev python3-dev python3-onnx
  python3-scipy python3-sklearn python3-matplotlib
)
[[ ${1:-all} != @(test|checks) ]] || packages+=(chromium-headless-shell python3-venv spin)
[[ ${1:-all} != checks ]] || packages+=(clang clang-format-19 clang-tidy libclang-rt-dev libopenmpi-dev openmpi-bin)
codename=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
# WebAssembly, for tools/sandbox. Debian 13 has no clang-16: there it is skipped.
[[ ${1:-all} != checks || $codename != bookworm ]] ||
  packages+=(clang-16 lld-16 wasi-libc libclang-rt-16-dev-wasm32 libc++-16-dev-wasm32)
arm64=(
  libtomlplusplus-dev libfmt-dev liburdfdom-dev libconsole-bridge-dev libtinyxml2-dev cyclonedds-dev libssl-dev
  libzstd-dev zlib1g-dev libgtest-dev libgmock-dev libmujoco-dev
)
[[ ${1:-all} != arm64 ]] || packages=(g++-aarch64-linux-gnu qemu-user-static "${arm64[@]/%/:arm64}")
# Named otherwise in Debian 13.
[[ $codename != trixie ]] ||
  packages=("${packages[@]/#libfastrtps-dev/libfastdds-dev}")

fail() {
  echo "install_packages.sh: $1" >&2
  exit 1
}

for tool in dpkg-query apt-get; do
  command -v "$tool" >/dev/null ||
    fail "found no $tool, expected Debian 12 or 13; the packages needed are: ${packages[*]}"
done

installed=$(dpkg-query --show --showformat='${db:Status-Status} ${Package}:${Architecture}\n' \
  "${packages[@]}" 2>/dev/null | sed -n 's/^installed //p') || true
native=$(dpkg --print-architecture) missing=()
for package in "${packages[@]}"; do
  grep -qxF -e "$package" -e "$package:$native" -e "$package:all" <<<"$installed" || missing+=("$package")
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
added=false
if [[ ${1:-all} == arm64 ]] && ! dpkg --print-foreign-architectures | grep -qx arm64; then
  "${as_root[@]}" dpkg --add-architecture arm64
  added=true
fi
give_up() { # with an architecture that the mirror lacks, every later update would fail too
  ! $added || "${as_root[@]}" dpkg --remove-architecture arm64 >&2 || true
  fail "$1"
}
"${apt[@]}" update >&2 || give_up "apt-get update failed, see above"
"${apt[@]}" install --yes --no-install-recommends "${missing[@]}" >&2 ||
  give_up "apt-get could not install: ${missing[*]}"
