# SPDX-License-Identifier: BSD-3-Clause
"""RslRlVecEnv: what rsl_rl's runner reads. Skips without PyTorch."""

import unittest

import numpy as np

from sandrunner import VectorEnv

try:
    import torch

    from sandrunner.rsl_rl import RslRlVecEnv
except ImportError:
    torch = None


@unittest.skipUnless(torch, "PyTorch is not installed (Debian: python3-torch)")
class RslRl(unittest.TestCase):
    def setUp(self):
        settings = {"episode.length_s": 0.2, "learner.block_envs": 16, "ground.rigid_envs": 16, "ground.patchy_envs": 0}
        self.envs = RslRlVecEnv(VectorEnv(num_envs=16, seed=2, settings=settings))
        self.plain = VectorEnv(num_envs=16, seed=2, settings=settings)

    def test_steps_are_those_of_the_environment_as_tensors_that_stay(self):
        first = self.envs.get_observations()["policy"]
        np.testing.assert_array_equal(first, self.plain.reset()[0])
        actions, kept, ended = torch.full((16, 12), 0.1), first.clone(), 0
        for _ in range(30):
            observations, rewards, dones, extras = self.envs.step(actions)
            plain = self.plain.step(actions.numpy())
            np.testing.assert_array_equal(observations["policy"], plain[0])
            np.testing.assert_array_equal(observations["critic"], plain[4]["privileged"])
            np.testing.assert_array_equal(rewards, plain[1])
            np.testing.assert_array_equal(dones, plain[2] | plain[3])
            np.testing.assert_array_equal(extras["time_outs"], plain[3])
            self.assertTrue((self.envs.episode_length_buf[dones.bool()] == 0).all())
            ended += int(dones.sum())
        self.assertTrue(torch.equal(first, kept))
        self.assertGreater(ended, 16)

    def test_says_how_large_everything_is(self):
        self.assertEqual((self.envs.num_envs, self.envs.num_actions, self.envs.max_episode_length), (16, 12, 20))
        self.assertEqual(tuple(self.envs.get_observations()["critic"].shape), (16, 77))


if __name__ == "__main__":
    unittest.main()
