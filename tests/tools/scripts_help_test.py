#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/tools/scripts_help_test.py ROOT: every script of the tree ROOT answers --help at once and does nothing else."""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
SOURCED = {"ros2_localhost.sh"}
SCRIPTS = [path for path in sorted(ROOT.glob("tools/**/*.sh")) if path.name not in SOURCED] + [ROOT / ".ci/run"]


class ScriptsHelp(unittest.TestCase):
    def test_help_is_printed_without_any_other_effect(self):
        self.assertGreater(len(SCRIPTS), 8)
        for script in SCRIPTS:
            for words in (["--help"], ["-h"], ["something", "--help"]):
                with self.subTest(script=script.name, words=words), tempfile.TemporaryDirectory() as folder:
                    tools, work = pathlib.Path(folder, "bin"), pathlib.Path(folder, "work")
                    tools.mkdir()
                    work.mkdir()
                    # All that the answer needs: what would install or build is not found.
                    for tool in ("bash", "sh", "sed", "dirname"):
                        (tools / tool).symlink_to(shutil.which(tool))
                    done = subprocess.run([shutil.which("bash"), script, *words], cwd=work, env={"PATH": str(tools)},
                                          capture_output=True, text=True, timeout=20, check=False)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    self.assertIn(script.name, done.stdout.splitlines()[0])
                    self.assertEqual(list(work.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
