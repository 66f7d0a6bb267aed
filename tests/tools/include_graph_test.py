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

    def test_an_arrow_up_is_named(self):
        self.assertIn("rt/core/a.h: includes rt/base/b.h", errors({"rt/core/a.h": ["rt/base/b.h"], "rt/base/b.h": []}))

    def test_siblings_do_not_include_each_other(self):
        self.assertIn("policy/a.h: includes estimator/b.h", errors({"policy/a.h": ["estimator/b.h"], "estimator/b.h": []}))

    def test_families_of_drives_are_siblings_above_what_they_share(self):
        shared = {"drivers/drives/a.h": [], "drivers/drives/b/c.h": ["drivers/drives/a.h"]}
        self.assertEqual(errors(shared), "")
        said = errors(shared | {"drivers/drives/d/e.h": ["drivers/drives/b/c.h"]})
        self.assertIn("drivers/drives/d/e.h: includes drivers/drives/b/c.h", said)

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

    def test_a_new_folder_needs_a_layer(self):
        self.assertIn("rt/new: a folder that is not among LAYERS", errors({"rt/new/a.h": []}))

    def test_a_new_driver_has_one(self):
        self.assertEqual(errors({"drivers/new/a.h": ["rt/base/b.h"], "rt/base/b.h": [], "drivers/c.h": ["drivers/new/a.h"]}), "")
        self.assertIn("drivers/new/a.h: includes drivers/c.h", errors({"drivers/new/a.h": ["drivers/c.h"], "drivers/c.h": []}))


if __name__ == "__main__":
    unittest.main()
