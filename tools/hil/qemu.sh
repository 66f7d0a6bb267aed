#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/hil/qemu.sh [--parallel] [--file FILE] [--out DIR] [--limit S] [--bin DIR] COMMAND: boots
# Debian's PREEMPT_RT kernel in QEMU with real SocketCAN (can0 to can3, CAN FD; vcan0, vcan1), runs
# the shell command in it, and ends with its exit code. sandrunner, sandrunner-hil and the programs
# of build/release/bin that the command names are in the guest's path. The command runs in /hil,
# which has the files of drivers/robot/examples and FILE (--file may be repeated), without input.
# What it leaves in /out is copied to DIR.
#
#   (without)   one processor, virtual time: an instruction takes a nanosecond, whatever else the
#               host does
#   --parallel  two processors, the host's time: threads are really parallel, and nothing is
#               repeatable
#
# Ends with 77 and one line if QEMU or a kernel to download is missing: tests then skip. Ends with
# 125 if the guest did not report within --limit seconds (default 170). The kernel comes from
# Debian's package, whose name apt-cache gives, and is kept in
# ${XDG_CACHE_HOME:-~/.cache}/sandrunner-hil.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
bin=$root/build/release/bin out="" limit=170 parallel=false files=()
while (($# > 1)); do
  case $1 in
  --parallel) parallel=true && shift ;;
  --file) files+=("$2") && shift 2 ;;
  --out) out=$2 && shift 2 ;;
  --limit) limit=$2 && shift 2 ;;
  --bin) bin=$2 && shift 2 ;;
  *) break ;;
  esac
done
if (($# != 1)); then
  echo "qemu.sh: found $# commands, expected one: [--parallel] [--file FILE] [--out DIR] [--limit S] [--bin DIR] COMMAND" >&2
  exit 2
fi
command=$1
for file in "${files[@]}"; do
  [[ -f $file ]] || { echo "qemu.sh: --file: found no file '$file'" >&2 && exit 2; }
done

skip() {
  echo "qemu.sh: skipped: $1" >&2
  exit 77
}
for tool in qemu-system-x86_64 busybox cpio xz apt-get dpkg-deb; do
  command -v "$tool" >/dev/null || skip "found no $tool (bash tools/install_packages.sh checks)"
done
[[ $(uname -m) == x86_64 ]] || skip "the emulated machine is x86-64, this one $(uname -m)"
file -L "$(command -v busybox)" | grep -q 'static' || skip "busybox is not the static one (Debian package busybox-static)"

# --- the kernel ---
cache=${XDG_CACHE_HOME:-$HOME/.cache}/sandrunner-hil
package=$(apt-cache depends linux-image-rt-amd64 2>/dev/null | awk '/Depends: linux-image-[0-9]/ { print $2; exit }')
[[ -n $package ]] || skip "found no package linux-image-rt-amd64, expected Debian's package lists (apt-get update)"
version=$(apt-cache policy "$package" | awk '/Candidate/ { print $2 }')
kernel=$cache/$package-$version
if [[ ! -e $kernel/vmlinux ]]; then
  mkdir -p "$cache"
  new=$(mktemp -d "$cache/new.XXXXXX")
  trap 'rm -rf "$new"' EXIT
  (cd "$new" && apt-get -qq -o APT::Sandbox::User=root download "$package" >&2) || skip "could not download $package"
  dpkg-deb --fsys-tarfile "$new"/*.deb | tar -x -C "$new" --wildcards './boot/vmlinuz-*' '*/kernel/net/can/*.ko*' \
    '*/kernel/drivers/net/can/dev/can-dev.ko*' '*/kernel/drivers/net/can/vcan.ko*' '*/kernel/drivers/net/can/slcan/slcan.ko*' \
    '*/kernel/drivers/virtio/*.ko*' '*/kernel/drivers/block/virtio_blk.ko*'
  rm "$new"/*.deb
  find "$new" -name '*.ko.xz' -exec xz -d {} + # Debian 13
  # The uncompressed kernel out of the bzImage: QEMU enters it directly, which saves the emulated xz
  # 3.5 s. Where it lies in there: Linux, Documentation/x86/boot.rst (setup_sects, payload_offset,
  # payload_length).
  image=$(echo "$new"/boot/vmlinuz-*)
  number() { od -An "-tu$2" "-j$1" "-N$2" "$image"; }
  dd if="$image" bs=1M iflag=skip_bytes,count_bytes skip=$((($(number 497 1) + 1) * 512 + $(number 584 4))) \
    count=$(($(number 588 4) - 4)) status=none >"$new/payload"
  # Debian 12 packs it with xz, 13 with zstd.
  xz -dc <"$new/payload" >"$new/vmlinux" 2>/dev/null || zstd -qdc <"$new/payload" >"$new/vmlinux"
  rm "$new/payload"
  mv -T "$new" "$kernel" 2>/dev/null || true # another call was quicker
  trap - EXIT
fi

# --- what the guest starts with ---
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
guest=$work/guest
mkdir -p "$guest"/{bin,usr/bin,dev,proc,sys,tmp,out,hil,modules}
cp "$(command -v busybox)" "$guest/bin/busybox"
find "$kernel" -name '*.ko' -exec cp -t "$guest/modules" {} +
cp "$root"/drivers/robot/examples/*.toml "${files[@]}" "$guest/hil"
programs=()
for program in "$bin"/*; do
  name=${program##*/}
  [[ -f $program && -x $program && " sandrunner sandrunner-hil ${command//[^a-zA-Z0-9_-]/ } " == *" $name "* ]] && programs+=("$program")
done
for program in "${programs[@]}"; do
  cp "$program" "$guest/usr/bin/"
  # A static program has none.
  { ldd "$program" 2>/dev/null | grep -o '/[^ ]*' || true; } | while read -r library; do
    mkdir -p "$guest${library%/*}"
    cp -L "$library" "$guest$library"
  done
  sha256sum "$program" | sed "s#$bin/##; s#^#host  #"
done
printf '%s\n' "$command" >"$guest/command"
cat >"$guest/init" <<'EOI'
#!/bin/busybox sh
/bin/busybox --install -s /bin
export PATH=/usr/bin:/bin HOME=/tmp
mount -t proc proc /proc
mount -t sysfs sys /sys
mount -t devtmpfs dev /dev
mkdir -p /dev/pts /dev/shm
mount -t devpts devpts /dev/pts
mount -t tmpfs tmpfs /dev/shm
for m in can can-raw can-dev vcan slcan virtio_ring virtio \
  virtio_pci_legacy_dev virtio_pci_modern_dev virtio_pci virtio_blk; do insmod /modules/$m.ko; done
ip link set lo up
for i in can0 can1 can2 can3 vcan0 vcan1; do
  ip link add $i type vcan && ip link set $i mtu 72 && ip link set $i up
done
cd /hil
for p in /usr/bin/*; do sha256sum $p | sed 's#/usr/bin/##; s#^#guest #'; done
echo "guest: Linux $(uname -rv)"
sh /command </dev/null
result=$?
(cd /out && tar -c . >/dev/vda)
# The only way to tell QEMU (isa-debug-exit): it ends with 2 x result + 1.
[ $result -gt 126 ] && result=126
printf "\\$(printf %o $result)" | dd of=/dev/port bs=1 seek=244 2>/dev/null
poweroff -f
EOI
chmod +x "$guest/init"
(cd "$guest" && find . | cpio -o -H newc --quiet) >"$work/initrd"

# --- boot ---
# KVM only with real hardware virtualisation: a /dev/kvm without it opens, and then runs no stock
# kernel.
machine=(-accel tcg,thread=single -smp 1 -icount "shift=0,sleep=off" -rtc clock=vm)
if $parallel; then
  machine=(-accel "tcg,thread=multi" -smp 2)
  grep -qwE 'vmx|svm' /proc/cpuinfo && [[ -w /dev/kvm ]] && machine=(-accel kvm -smp 2)
fi
truncate -s 64M "$work/out.tar"
status=0
timeout "$limit" qemu-system-x86_64 -nodefaults -no-user-config -M q35 "${machine[@]}" -cpu max -m 1024 -display none \
  -no-reboot -serial stdio -drive "file=$work/out.tar,format=raw,if=virtio" -kernel "$kernel/vmlinux" -initrd "$work/initrd" \
  -append "console=ttyS0 quiet panic=-1 nokaslr tsc=reliable mitigations=off no5lvl nowatchdog" -device isa-debug-exit,iobase=0xf4,iosize=0x04 \
  </dev/null || status=$?
if [[ -n $out ]]; then
  mkdir -p "$out"
  tar -x -C "$out" -f "$work/out.tar" 2>/dev/null || true
fi
((status % 2 == 1 && status < 254)) && exit $((status / 2))
echo "qemu.sh: the guest did not report within $limit s (QEMU's exit code $status); --limit S gives it more" >&2
exit 125
