#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/tools/evaluate/corners_test.py FOLDER: what tools/evaluate/corners.py flies."""
import itertools
import sys
import unittest

sys.path.append(sys.argv.pop(1))
import corners as script  # noqa: E402: its folder is an argument


class CornersTest(unittest.TestCase):
    def test_every_pair_of_commands_has_a_file_of_its_own(self):
        commands = script.corners(forward=3, back=0.8, lateral=0.5, yaw=1, centripetal=1.5)
        pairs = list(itertools.permutations(commands, 2))
        self.assertEqual(len({script.command_file(*pair) for pair in pairs}), len(pairs))


if __name__ == "__main__":
    unittest.main()
