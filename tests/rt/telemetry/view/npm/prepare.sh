# SPDX-License-Identifier: BSD-3-Clause
# To be sourced: prepare WHAT FOLDER sets `browser`, has the packages of package-lock.json installed
# in FOLDER and puts the scripts there. Ends the script with 77 and a line that says why if they are
# not to be had: WHAT is skipped.
prepare() {
  local what=$1 folder=$2 here name
  here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
  browser=
  for name in chromium-headless-shell chromium google-chrome; do
    browser=$(command -v "$name") && break
  done
  [[ -n $browser ]] || { echo "SKIPPED: $what needs Debian's chromium-headless-shell, which is not installed"; exit 77; }
  source "$here/../../npm_packages.sh"
  npm_packages "$what" "$here" "$folder"
  cp "$here"/*.mjs "$folder/"
}
