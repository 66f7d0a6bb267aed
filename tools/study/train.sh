#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# tools/study/train.sh DIR SEED [NAME ...]: trains the controllers of trainings/ (all of them
# without a name) with this seed in DIR/NAME-SEED. It continues a training that was interrupted. Of
# one that is complete it puts the policy of the end and a short learning curve into DIR:
# NAME-SEED.safetensors, NAME-SEED.csv. (Not the best policy of the battery: for some controllers
# that is one of before the late penalties, so their training would differ in length and reward.) A
# student (pl-*) imitates the teacher of this seed in DIR.
# All have windows of 128 steps and 256 robots (NOTES.md of tools/train, 23).
# TRANSITIONS: length of each training, the same for all controllers that are compared; a teacher
# has three fifths of it, its student the other two.
# THREADS: worker threads of a training, without it all cores; weights do not depend on it.
set -eu
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done
here=$(cd "$(dirname "$0")" && pwd)
program=${SANDRUNNER_TRAIN:-$here/../../build/release/bin/sandrunner-train}
transitions=${TRANSITIONS:-120e6}
if [ $# -lt 2 ]; then
  echo "train.sh: found $# arguments, expected DIR SEED [NAME ...]" >&2
  exit 2
fi
out=$1 seed=$2
shift 2
[ $# -gt 0 ] || set -- ours env-rigid env-linear env-quasistatic tcn oracle-h oracle-o teacher-gm teacher-rigid \
  pl-gm pl-rigid
for name in "$@"; do
  if [ ! -f "$here/trainings/$name.toml" ]; then
    echo "train.sh: found '$name', expected one of" "$(cd "$here/trainings" && echo *.toml)" >&2
    exit 2
  fi
done
mkdir -p "$out"
for name in "$@"; do
  run=$out/$name-$seed
  length=$transitions
  teacher=
  fifths=5
  case $name in teacher-*) fifths=3 ;; pl-*) fifths=2 ;; esac
  [ "$fifths" = 5 ] || length=$(awk -v all="$transitions" -v n="$fifths" 'BEGIN { printf "%.0f", n / 5 * all }')
  case $name in pl-*)
    teacher=$out/teacher-${name#pl-}-$seed.safetensors
    if [ ! -f "$teacher" ]; then
      echo "train.sh: found no $teacher, expected that of teacher-${name#pl-}: train it first" >&2
      exit 2
    fi ;;
  esac
  resume=
  [ ! -f "$run/checkpoint.bin" ] || resume=--resume
  "$program" --config "$here/trainings/$name.toml" --set learner.window=128 --set run.envs=256 \
    --set run.transitions="$length" \
    ${teacher:+--set "imitation.teacher=$teacher"} --seed "$seed" ${THREADS:+--threads "$THREADS"} --out "$run" $resume
  if ! awk -F, -v all="$length" 'END { exit !($2 + 0 >= all + 0) }' "$run/curve.csv"; then
    echo "train.sh: $run is not complete: run the same command again" >&2
    exit 1
  fi
  cp "$run/policy.safetensors" "$run.safetensors"
  # Every twentieth row and the last one.
  awk -F, -v names="transitions core_hours reward battery_alive battery_error \
battery_cost_of_transport command_speed_mps ground_open" '
    function print_row(fields) {
      for (i = 1; i <= wanted; ++i) printf "%s%s", fields[column[name[i]]], i < wanted ? "," : "\n"
    }
    NR == 1 { wanted = split(names, name, " "); for (i = 1; i <= NF; ++i) column[$i] = i }
    { count = split($0, last, ",") }
    NR == 1 || NR % 20 == 2 { print_row(last); printed = NR }
    END { if (printed != NR) print_row(last) }' "$run/curve.csv" > "$run.csv"
done
