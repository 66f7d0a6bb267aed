#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/tools/skipped_tests_test.py SCRIPT: skipped_tests.py on results as ctest writes them."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = sys.argv.pop(1)


def printed(*cases):
    """What skipped_tests.py prints for `cases`: name, status, output."""
    text = "".join(
        f'<testcase name="{name}" status="{status}"><system-out>{output}</system-out></testcase>'
        for name, status, output in cases)
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "results.xml")
        file.write_text(f"<testsuite>{text}</testsuite>")
        return subprocess.run([sys.executable, SCRIPT, file], capture_output=True, text=True, check=True).stdout


class SkippedTestsTest(unittest.TestCase):
    def test_nothing_is_printed_if_all_ran(self):
        self.assertEqual(printed(("A", "run", ""), ("B", "fail", "b.cpp:1: Skipped\nno b")), "")

    def test_tests_are_listed_by_the_reason_they_printed(self):
        self.assertEqual(
            printed(("A", "notrun", "[ RUN ] A\na.cpp:7: Skipped\nno CAN\n[ SKIPPED ] A\n"), ("B", "run", ""),
                    ("C", "notrun", "qemu.sh: skipped: no busybox\n"), ("D", "notrun", "SKIPPED: D needs npm\n"),
                    ("E", "notrun", "x.cpp:9: Skipped\nno CAN\n"), ("F", "notrun", "")),
            "\nSkipped tests:\n  D needs npm: D\n  it printed no reason: F\n  no CAN: A, E\n  no busybox: C\n")


unittest.main()
