#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/hil/test.sh short|walk|faults|cost|check|nudge|record|parallel|full [BIN]: the controller
# against the bench in the emulated machine (qemu.sh), with the programs in BIN (default
# build/release/bin); judges, and prints what was measured.
#
#   short     what tools/test.sh runs: tests that need CAN in the kernel, one protocol walks 2 s,
#             some fault runs
#   walk      both protocols in both modes walk 10 s at 1 kHz, at the speed of the same program in
#             its own simulator
#   faults    the whole list of fault runs
#   cost      what a control tick costs with twelve drives on four buses in torque mode; its system
#             calls
#   check     `sandrunner check --move`, each joint turned by a hand: one has the wrong sign, two
#             are swapped
#   nudge     `sandrunner check --nudge`, each drive pushes its joint: the torque of one acts the
#             other way
#   record    a recording made over CAN, replayed here
#   parallel  two processors in the host's time: what needs no walk, which an emulated machine is
#             too slow for
#   full      all of these
# Files are left in build/hil.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

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
  rm -rf "$out/in-process" "$out/in-process.log"
  "$bin/sandrunner" --command 1,0,0 --duration "$1" --out "$out/in-process" >"$out/in-process.log" 2>&1 </dev/null || {
    echo "test.sh: the walk in the program's own simulator ended with exit code $?:" >&2
    tail -n 5 "$out/in-process.log" >&2
    return 1
  }
  sed -n '/"mean_velocity_mps"/ { n; s/[ ,]//g; p; q }' "$out/in-process/summary.json" | grep -x '[0-9.e-]*[0-9]' || {
    echo "test.sh: $out/in-process/summary.json: found no number as mean_velocity_mps" >&2
    return 1
  }
}
# After a fault the robot is damped for 2 s; a quarter of that is enough to see it.
faults='--walk 1 --set controller.damping.fault_s=0.5 --out /out'

case $lane in
short)
  speed=$(speed 2)
  guest short 1400 "can_test --gtest_brief=1 --gtest_filter='CanSocket*' &&
    sandrunner-hil runs --only walks-mit --walk 2 --speed $speed --out /out &&
    sandrunner-hil runs --only drive-resets,damiao-reboots,wrong-mode,bus-off,imu-silent $faults"
  ;;
walk)
  speed=$(speed 10)
  walk="sandrunner-hil runs --only walks-mit,walks-damiao,walks-moteus --walk 10 --speed $speed --set hardware.rate_hz=1000"
  guest walk 1800 "$walk --out /out && $walk --set hardware.mode=torque --out /out/torque"
  ;;
faults) guest faults 3600 "sandrunner-hil runs $faults" ;;
cost)
  # At 4 kHz, a tick sends to all drives and reads what they answered to the last one. Here the
  # drives share the controller's processor, and 250 us are not enough for both: they are exchanged
  # with at 1 kHz, one tick sends, the next reads, and the two are added. In the middle of the walk
  # the kernel counts the system calls of the control thread (the one at priority 80).
  guest cost 900 "mount -t tracefs tracefs /sys/kernel/tracing
    calls=/sys/kernel/tracing/events/raw_syscalls/sys_enter
    sandrunner-hil --hardware moteus.toml --set hardware.imu.device=/tmp/imu & sleep 1
    sandrunner --hardware moteus.toml --arm --command 1,0,0 --duration 2 --set hardware.imu.device=/tmp/imu \
      --set hardware.mode=torque --set hardware.rate_hz=1000 2>&1 | tee /tmp/log & sleep 5
    for task in /proc/\$(pidof sandrunner)/task/*; do
      [ \"\$(cut -d ' ' -f 40 \$task/stat)\" = 80 ] && echo \"hist:keys=id.syscall if common_pid == \${task##*/}\" >\$calls/trigger
    done
    sleep 0.5
    sed -n 's/^{ id: \([a-z_]*\).*hitcount:/control thread, calls in 0.5 s: \1/p' \$calls/hist >/tmp/calls
    wait %2
    cat /tmp/calls
    awk '/^  (sensors|control step|drives or)/ { p += \$(NF - 1); most += \$NF }
      END { printf \"a tick at 4 kHz, 12 frames in, 12 out: p99.9 %.0f us, at most %.0f us of 250\\n\", p, most }' /tmp/log"
  ;;
check)
  # The file of the check has the wrong sign for RF_HAA; at the robot two drives have each other's
  # id. A joint has 1.4 s: Enter, after 0.3 s the hand, which takes 0.5 s, after 1.2 s Enter.
  guest check 900 'joints=$(sed -n "s/^joint = \"\(.*\)\"/\1/p" moteus.toml)
    sed "s|^device = \"[^\"]*\"|device = \"/tmp/imu\"|" moteus.toml >robot.toml
    awk "/RF_HAA/ { wrong = 1 } /^sign/ && wrong { sub(1, -1); wrong = 0 } { print }" robot.toml >/tmp/check.toml
    set -- --fault "start swapped LH_HFE LH_KFE"
    t=43
    for joint in $joints; do
      set -- "$@" --fault "start+$((t / 10)).$((t % 10)) turns $joint 0.5"
      t=$((t + 14))
    done
    sandrunner-hil --hardware robot.toml "$@" &
    { sleep 4; for joint in $joints; do echo; sleep 1.2; echo; sleep 0.2; done; echo s; } |
      sandrunner check /tmp/check.toml --move >/out/check.txt 2>/out/asked.txt
    echo "exit code $?"
    cat /out/check.txt' | tee "$out/check.log"
  report=$out/check/check.txt
  grep -q 'exit code 1' "$out/check.log" && grep -q 'RF_HAA .* the other way: set sign = 1' "$report" &&
    grep -q 'LH_HFE .*: the drive of LH_KFE .* swap them' "$report" &&
    grep -q 'LH_KFE .*: the drive of LH_HFE .* swap them' "$report" && (($(grep -c 'as it should' "$report") == 9))
  ;;
nudge)
  guest nudge 600 'sed "s|^device = \"[^\"]*\"|device = \"/tmp/imu\"|" moteus.toml >robot.toml
    sandrunner-hil --hardware robot.toml --fault "start stand" --fault "start reversed RF_HFE" &
    sleep 4
    { echo; sleep 30; } | sandrunner check robot.toml --nudge --set hardware.hanging=true >/out/check.txt 2>/out/asked.txt
    echo "exit code $?"
    cat /out/asked.txt /out/check.txt' | tee "$out/nudge.log"
  report=$out/nudge/check.txt
  grep -q 'exit code 1' "$out/nudge.log" && grep -q 'RF_HFE .* wrong sign' "$report" &&
    (($(grep -c 'as they should' "$report") == 11))
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
    imu_test --gtest_brief=1 && sandrunner-hil runs --only swapped-ids,wrong-scale $faults"
  ;;
full)
  for each in short walk faults cost check nudge record parallel; do
    echo "== $each"
    bash "${BASH_SOURCE[0]}" "$each" "$bin"
  done
  ;;
*)
  echo "test.sh: found '$lane', expected short, walk, faults, cost, check, nudge, record, parallel or full" >&2
  exit 2
  ;;
esac
