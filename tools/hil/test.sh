#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/hil/test.sh short|walk|faults|cost|record|parallel|full [BIN]: the controller against the bench in the emulated
# machine (qemu.sh), with the programs in BIN (default build/release/bin); judges, and prints what was measured.
#
#   short     what tools/test.sh runs: tests that need CAN in the kernel, both protocols walk 2 s, some fault runs
#   walk      both protocols walk 10 s at 1 kHz, at the speed of the same program in its own simulator
#   faults    the whole list of fault runs
#   cost      what a control tick costs with twelve drives on four buses in torque mode
#   record    a recording made over CAN, replayed here
#   parallel  two processors in the host's time: functional, nothing of time is judged
#   full      all of these
# Files are left in build/hil.
set -euo pipefail

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
lane=${1:-} bin=${2:-$root/build/release/bin}
out=$root/build/hil
machine=()
mkdir -p "$out"

guest() { # NAME LIMIT COMMAND: files in $out/NAME
  rm -rf "${out:?}/$1"
  bash "$root/tools/hil/qemu.sh" "${machine[@]}" --bin "$bin" --out "$out/$1" --limit "$2" "$3"
}
# Speed in the second half of a walk of $1 s in the program's own simulator.
speed() {
  "$bin/sandrunner" --command 1,0,0 --duration "$1" --out "$out/in-process" >/dev/null 2>&1 </dev/null
  sed -n '/"mean_velocity_mps"/ { n; s/[ ,]//g; p; q }' "$out/in-process/summary.json"
}
# After a fault the robot is damped for 2 s; a quarter of that is enough to see it.
faults='--walk 1 --set controller.damping.fault_s=0.5 --out /out'

case $lane in
short)
  guest short 600 "can_test --gtest_brief=1 --gtest_filter='CanSocket*' &&
    sandrunner-hil runs --only walks-mit,walks-moteus --walk 2 --speed $(speed 2) --out /out &&
    sandrunner-hil runs --only drive-resets,bus-off,imu-silent $faults"
  ;;
walk)
  guest walk 1800 "sandrunner-hil runs --only walks-mit,walks-moteus --walk 10 --speed $(speed 10) \
    --set hardware.rate_hz=1000 --out /out"
  ;;
faults) guest faults 3600 "sandrunner-hil runs $faults" ;;
cost)
  # The drives share the controller's one processor, which is too slow for both at 4 kHz: they answer late, and the
  # controller is told to bear that. What it does in a tick is the same.
  guest cost 900 "sandrunner-hil --hardware moteus.toml --set hardware.imu.device=/tmp/imu & sleep 1;
    sandrunner --hardware moteus.toml --arm --command 1,0,0 --duration 1 --set hardware.imu.device=/tmp/imu \
      --set hardware.mode=torque --set hardware.rate_hz=4000
    echo 'system calls of the control thread, from its first wake-up on, under strace:'
    strace -ff -qq -o /tmp/trace sandrunner --hardware moteus.toml --arm --duration 1 \
      --set hardware.imu.device=/tmp/imu >/dev/null 2>&1
    for t in /tmp/trace.*; do
      grep -q sendmmsg \$t && grep -q clock_nanosleep \$t && sed -n '/^clock_nanosleep/,\$p' \$t |
        sed 's/(.*//' | sort | uniq -c
    done; true"
  ;;
record)
  guest record 900 "sandrunner-hil --hardware moteus.toml --set hardware.imu.device=/tmp/imu & sleep 1;
    sandrunner --hardware moteus.toml --arm --command 1,0,0 --duration 2 --set hardware.imu.device=/tmp/imu \
      --record /out"
  "$bin/sandrunner-replay" "$out/record/run.mcap"
  ;;
parallel)
  machine=(--parallel)
  guest parallel 600 "can_test --gtest_brief=1 --gtest_filter='CanSocket*' &&
    imu_test --gtest_brief=1 && sandrunner-hil runs --only swapped-ids,wrong-scale $faults &&
    { sandrunner-hil runs --only walks-moteus --walk 2 --out /out || echo 'not judged: this machine is too slow'; }"
  ;;
full)
  for each in short walk faults cost record parallel; do
    echo "== $each"
    bash "${BASH_SOURCE[0]}" "$each" "$bin"
  done
  ;;
*)
  echo "test.sh: found '$lane', expected short, walk, faults, cost, record, parallel or full" >&2
  exit 2
  ;;
esac
