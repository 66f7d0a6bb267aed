#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/deploy/man_page.sh PROGRAM SUMMARY FILE [EMULATOR]: writes the man page of PROGRAM to
# FILE.1, and what bash completes behind its name to FILE.bash, both from its --help and that of its
# subcommands. SUMMARY is the page's one-line description; EMULATOR runs a PROGRAM for another
# processor. Needs help2man.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

program=$1 summary=$2 file=$3
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
if [[ ${4:-} ]]; then
  printf '#!/bin/sh\nexec "%s" "%s" "$@"\n' "$4" "$(realpath "$program")" >"$folder/${program##*/}"
  program=$folder/${program##*/}
  chmod +x "$program"
fi
sections=$folder/sections
options() { grep -oE '^  (-[a-z],)?--[a-z-]+' | sed 's/.*--/--/'; }

mapfile -t subcommands < <("$program" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z-]*\) .*/\1/p')
words=$("$program" --help | options)
for subcommand in "${subcommands[@]}"; do
  printf '[SUBCOMMAND %s]\n.nf\n' "${subcommand^^}"
  "$program" "$subcommand" --help | sed 's/\\/\\\\/g; s/-/\\-/g; s/^[.'\'']/\\\&&/'
  printf '.fi\n\n'
  words+=" $subcommand "$("$program" "$subcommand" --help | options)
done >"$sections"
printf '[SEE ALSO]\n/usr/share/doc/sandrunner/README.md and the documents next to it\n' >>"$sections"
help2man --no-info --section=1 --name="$summary" --include="$sections" --output="$file.1" "$program"
words=$(tr ' ' '\n' <<<"$words" | sort -u | xargs)
printf "complete -o default -W '%s' %s\n" "$words" "${program##*/}" >"$file.bash"
