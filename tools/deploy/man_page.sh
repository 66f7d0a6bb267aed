#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/deploy/man_page.sh PROGRAM SUMMARY FILE [SUBCOMMAND...]: writes the man page of PROGRAM to
# FILE, from its --help and that of its subcommands. SUMMARY is the page's one-line description.
# Needs help2man.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

program=$1 summary=$2 file=$3
shift 3
sections=$(mktemp)
trap 'rm -f -- "$sections"' EXIT
for subcommand; do
  printf '[SUBCOMMAND %s]\n.nf\n' "${subcommand^^}"
  "$program" "$subcommand" --help | sed 's/\\/\\\\/g; s/-/\\-/g; s/^[.'\'']/\\\&&/'
  printf '.fi\n\n'
done >"$sections"
printf '[SEE ALSO]\n/usr/share/doc/sandrunner/README.md and the documents next to it\n' >>"$sections"
help2man --no-info --section=1 --name="$summary" --include="$sections" --output="$file" "$program"
