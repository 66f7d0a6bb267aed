# SPDX-License-Identifier: BSD-3-Clause
"""What gymnasium gets: registered names, and no frames. The real package is used where it is installed."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import sandrunner

try:
    import gymnasium
except ImportError:
    gymnasium = None

# The part of the package that a registration meets: make_vec loads the entry point and calls it
# with num_envs and the keywords of the registration and of the call, as in gymnasium 1.3.
STAND_IN = """
import importlib
registry = {}

def register(id, entry_point=None, *, vector_entry_point=None, kwargs=None):
    registry[id] = vector_entry_point, kwargs

def make_vec(id, num_envs=1, **given):
    entry_point, kwargs = registry[id]
    module, name = entry_point.split(":")
    return getattr(importlib.import_module(module), name)(num_envs=num_envs, **{**kwargs, **given})
"""


class Registered(unittest.TestCase):
    def test_both_robots_are_there_after_the_import(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "gymnasium.py").write_text(STAND_IN)
            code = ("import gymnasium, sandrunner; print(sorted(gymnasium.registry)); "
                    "print(gymnasium.make_vec('sandrunner/Raibo-v0', num_envs=64, seed=5)); "
                    "print(gymnasium.make_vec('sandrunner/Go2-v0', num_envs=64, actions='modes'))")
            environment = {**os.environ, "PYTHONPATH": f"{folder}:{os.environ['PYTHONPATH']}"}
            out = subprocess.run([sys.executable, "-c", code], env=environment, check=True, capture_output=True, text=True)
        self.assertEqual(out.stdout.splitlines(), [
            "['sandrunner/Go2-v0', 'sandrunner/Raibo-v0']",
            "VectorEnv('raibo', num_envs=64, seed=5, actions='joints')",
            "VectorEnv('go2', num_envs=64, seed=1, actions='modes')"])

    @unittest.skipUnless(gymnasium, "gymnasium is not installed (pip install gymnasium)")
    def test_make_vec_of_the_real_package_makes_one_that_its_wrappers_take(self):
        envs = gymnasium.make_vec("sandrunner/Go2-v0", num_envs=64, seed=5, settings={"episode.length_s": 0.1})
        self.assertIsInstance(envs, gymnasium.vector.VectorEnv)
        self.assertEqual(envs.spec.id, "sandrunner/Go2-v0")
        self.assertEqual(envs.joint_names, sandrunner.VectorEnv("go2", num_envs=64).joint_names)
        counted = gymnasium.wrappers.vector.RecordEpisodeStatistics(envs)
        counted.reset(seed=1)
        lengths = [counted.step(np.zeros((64, 12), np.float32))[4].get("episode", {}).get("l") for _ in range(12)]
        self.assertLessEqual(max(length.max() for length in lengths if length is not None), 10)
        with self.assertRaisesRegex(ValueError, "^num_envs: found 1, expected a multiple of learner.block_envs"):
            gymnasium.make_vec("sandrunner/Raibo-v0")


class NoFrames(unittest.TestCase):
    EXPECTED = r"expected None: sandrunner.Recording \(examples/look.py\) .* tools/moving_picture.sh"

    def test_a_render_mode_is_refused_with_what_to_use(self):
        with self.assertRaisesRegex(ValueError, "^render_mode: found 'rgb_array', " + self.EXPECTED):
            sandrunner.VectorEnv(num_envs=64, render_mode="rgb_array")

    def test_render_says_the_same(self):
        envs = sandrunner.VectorEnv(num_envs=64, render_mode=None)
        self.assertIsNone(envs.render_mode)
        with self.assertRaisesRegex(NotImplementedError, r"^VectorEnv: found a call of render\(\), " + self.EXPECTED):
            envs.render()


if __name__ == "__main__":
    unittest.main()
