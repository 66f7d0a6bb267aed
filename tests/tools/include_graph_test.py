#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/tools/include_graph_test.py SCRIPT: include_graph.py on small trees."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = sys.argv.pop(1)


def errors(files):
    """What include_graph.py says against a tree of `files`: path -> what it includes; "" if nothing."""
    with tempfile.TemporaryDirectory() as root:
        for path, includes in files.items():
            file = pathlib.Path(root, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text("".join(f'#include "{other}"\n' for other in includes))
        run = subprocess.run([sys.executable, SCRIPT, root], capture_output=True, text=True, check=False)
        assert run.returncode == (1 if run.stderr else 0), run
        return run.stderr


class IncludeGraphTest(unittest.TestCase):
    def test_arrows_down_are_fine(self):
        self.assertEqual(errors({"rt/loop/a.cpp": ["rt/loop/a.h"], "rt/loop/a.h": ["rt/core/b.h"], "rt/core/b.h": []}), "")

    def test_a_circle_of_folders_is_named(self):
        said = errors({"rt/core/a.h": ["rt/base/b.h"], "rt/base/b.h": [], "rt/base/c.h": ["rt/core/d.h"], "rt/core/d.h": []})
        self.assertRegex(said, "a circle: rt/(core -> rt/base -> rt/core|base -> rt/core -> rt/base)")

    def test_a_circle_within_a_folder_is_named(self):
        said = errors({"rt/base/a.h": ["rt/base/b.h"], "rt/base/b.h": ["rt/base/a.h"]})
        self.assertIn("a circle: ", said)

    def test_the_loop_reaches_no_simulator_by_any_way(self):
        said = errors({
            "rt/loop/a.h": ["rt/base/b.h"],
            "rt/base/b.h": ["sim/c.h"],
            "sim/c.h": [],
        })
        self.assertIn("rt/loop/a.h -> rt/base/b.h -> sim/c.h", said)


if __name__ == "__main__":
    unittest.main()
