# SPDX-License-Identifier: BSD-3-Clause
# To be sourced: npm_packages WHAT HERE FOLDER has the packages of HERE/package-lock.json installed
# in FOLDER. Ends the script with 77 and a line that says why if they are not to be had: WHAT is
# skipped.
npm_packages() {
  local what=$1 here=$2 folder=$3
  skip() {
    echo "SKIPPED: $what needs $1"
    exit 77
  }
  command -v node >/dev/null && command -v npm >/dev/null || skip "node and npm, which are not installed"
  mkdir -p "$folder"
  # The stamp is written last, so that a broken installation is done again.
  if ! cmp -s "$here/package-lock.json" "$folder/installed.json"; then
    cp "$here/package.json" "$here/package-lock.json" "$folder/"
    install() {
      (cd "$folder" && npm ci --ignore-scripts --no-audit --no-fund --fetch-retries=1 --fetch-timeout=20000 >npm.log 2>&1)
    }
    if ! install && ! install; then
      npm ping --fetch-retries=0 --fetch-timeout=5000 >/dev/null 2>&1 || skip "the npm registry, which does not answer"
      cat "$folder/npm.log"
      exit 1
    fi
    cp "$here/package-lock.json" "$folder/installed.json"
  fi
}
