#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/run.sh [arguments]: installs what is missing, builds, and runs sandrunner with the arguments in the present
# folder. Only the program writes to stdout.
set -euo pipefail

root=$(cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
bash "$root/tools/build.sh" sandrunner
exec "$root/build/release/bin/sandrunner" "$@"
