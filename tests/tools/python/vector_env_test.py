# SPDX-License-Identifier: BSD-3-Clause
"""VectorEnv: the bits of sandrunner-train, arrays without copies, and what gymnasium expects."""

import os
import pathlib
import resource
import subprocess
import tempfile
import threading
import unittest

import numpy as np

import sandrunner
from sandrunner import Recording, VectorEnv

REFERENCE = pathlib.Path(os.environ["SANDRUNNER_BIN"], "rollout_reference")
ENVS, STEPS, SEED = 256, 224, 7  # seven windows
# Episodes end by falls and by time, and the curriculum moves, within the steps.
SETTINGS = ["episode.length_s=0.6", "episode.push_probability=0.001", "episode.push_speed_mps=6", "learner.window=32"]


def reference_rollout():
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder, "rollout")
        subprocess.run([REFERENCE, path, str(ENVS), str(STEPS), str(SEED), *SETTINGS], check=True)
        step = np.dtype(
            [("actions", "f4", (ENVS, 12)), ("observation", "f4", (ENVS, 33)), ("privileged", "f4", (ENVS, 77)),
             ("estimate_target", "f4", (ENVS, 8)), ("reward", "f4", ENVS), ("end", "u1", ENVS), ("reset", "u1", ENVS)])
        content = path.read_bytes()
        first = np.frombuffer(content, "f4", ENVS * 33).reshape(ENVS, 33)
        steps = np.frombuffer(content, step, STEPS, first.nbytes)
        speed = np.frombuffer(content, "f8", 1, first.nbytes + steps.nbytes)[0]
        assert len(content) == first.nbytes + steps.nbytes + 8
        return first, steps, speed


class SameBits(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.first, cls.steps, cls.speed = reference_rollout()

    def follow(self, threads, width):
        envs = VectorEnv(num_envs=ENVS, seed=SEED, threads=threads, settings=SETTINGS, actions="modes", width=width)
        observation, info = envs.reset()
        np.testing.assert_array_equal(observation, self.first)
        for k, step in enumerate(self.steps):
            observation, reward, terminated, truncated, info = envs.step(step["actions"])
            for name, found, expected in (
                ("observation", observation, step["observation"]),
                ("privileged", info["privileged"], step["privileged"]),
                ("estimate_target", info["estimate_target"], step["estimate_target"]),
                ("reward", reward, step["reward"]),
                ("terminated", terminated, step["end"] == 1),
                ("truncated", truncated, step["end"] == 2),
                ("reset", info["reset"], step["reset"] == 1),
            ):
                self.assertEqual(found.tobytes(), expected.astype(found.dtype).tobytes(), f"{name} of step {k}")
        self.assertEqual(envs.curriculum["speed_mps"], self.speed)

    def test_the_reference_has_falls_timeouts_and_a_curriculum_that_moves(self):
        self.assertGreater((self.steps["end"] == 1).sum(), 0)
        self.assertGreater((self.steps["end"] == 2).sum(), 0)
        self.assertGreater(self.speed, 1.0)

    def test_a_rollout_of_the_trainer_comes_out_at_one_thread_and_two_and_every_width(self):
        for threads, width in ((1, 1), (2, 8), (1, 16), (2, 0)):
            with self.subTest(threads=threads, width=width):
                try:
                    self.follow(threads, width)
                except ValueError as error:
                    if "no AVX-512" not in str(error):
                        raise


class Arrays(unittest.TestCase):
    def setUp(self):
        self.envs = VectorEnv(num_envs=64, seed=3)

    def test_stay_at_their_address_for_100_steps(self):
        observation, _ = self.envs.reset()
        actions = np.zeros((64, 12), np.float32)
        address, before = observation.ctypes.data, observation.copy()
        for _ in range(100):
            stepped, reward, *_ = self.envs.step(actions)
            self.assertEqual(stepped.ctypes.data, address)
        self.assertFalse(np.array_equal(before, observation))

    def test_are_copies_if_asked_for(self):
        envs = VectorEnv(num_envs=64, copy=True)
        observation, info = envs.reset()
        stepped, _, _, _, info_after = envs.step(np.zeros((64, 12), np.float32))
        self.assertFalse(np.shares_memory(observation, stepped))
        self.assertFalse(np.shares_memory(info["privileged"], info_after["privileged"]))

    def test_outlive_the_environment(self):
        observation, _ = self.envs.reset()
        kept = observation.copy()
        self.envs.close()
        del self.envs
        np.testing.assert_array_equal(observation, kept)

    def test_take_no_more_memory_after_ten_thousand_steps(self):
        envs = VectorEnv(num_envs=16, settings={"learner.block_envs": 16, "ground.rigid_envs": 16, "ground.patchy_envs": 0})
        actions = np.zeros((16, 12), np.float32)
        for _ in range(1000):
            envs.step(actions)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        for _ in range(9000):
            envs.step(actions)
        self.assertLess(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before, 1024)  # KiB

    def test_another_thread_makes_progress_during_a_step(self):
        envs = VectorEnv(num_envs=4096)
        actions = np.zeros((4096, 12), np.float32)
        counts, in_step, done = [0, 0], False, False

        def count():
            while not done:
                counts[in_step] += 1

        thread = threading.Thread(target=count)
        thread.start()
        for _ in range(5):
            native = envs._native
            in_step = True
            native.step(actions)
            in_step = False
        done = True
        thread.join()
        self.assertGreater(counts[True], 1000)

    def test_what_a_step_writes_is_not_read_by_another_thread_during_it(self):
        envs = VectorEnv(num_envs=4096)
        native, actions = envs._native, np.zeros((4096, 12), np.float32)
        for read in (native.statistics, native.progress, Recording(envs).add):
            thread = threading.Thread(target=native.step, args=(actions,))
            thread.start()
            with self.assertRaisesRegex(ValueError, "expected one at a time"):
                while thread.is_alive():
                    read()
            thread.join()


class Contract(unittest.TestCase):
    def test_the_same_seed_gives_the_same_episodes_and_another_others(self):
        envs = VectorEnv(num_envs=64, seed=5)
        first = envs.reset()[0].copy()
        second = envs.step(np.full((64, 12), 0.1, np.float32))[0].copy()
        np.testing.assert_array_equal(envs.reset(seed=5)[0], first)
        np.testing.assert_array_equal(envs.step(np.full((64, 12), 0.1, np.float32))[0], second)
        self.assertFalse(np.array_equal(envs.reset()[0], first))
        self.assertFalse(np.array_equal(envs.reset(seed=6)[0], first))

    def test_streams_of_different_seeds_never_meet_whatever_the_resets(self):
        envs = VectorEnv(num_envs=64, seed=1, copy=True)
        streams = {envs.reset()[0].tobytes()}  # as it was made: that of seed 1
        for seed in range(1, 17):
            streams.add(envs.reset(seed=seed)[0].tobytes())
            for _ in range(2):
                streams.add(envs.reset()[0].tobytes())
        self.assertEqual(len(streams), 48)

    def test_a_reset_without_a_seed_draws_anew_and_repeats_with_its_seed(self):
        a, b = (VectorEnv(num_envs=64, seed=6, copy=True) for _ in range(2))
        for _ in range(3):
            np.testing.assert_array_equal(a.reset()[0], b.reset()[0])

    def test_it_says_what_it_is(self):
        self.assertEqual(repr(VectorEnv(num_envs=64, seed=5)),
                         "VectorEnv('raibo', num_envs=64, seed=5, actions='joints')")
        self.assertEqual(repr(sandrunner.Batch(num_robots=2)), "Batch('raibo', num_robots=2)")
        self.assertRegex(sandrunner.__version__, r"^\d+\.\d+\.\d+$")
        self.assertEqual(VectorEnv(num_envs=64).unwrapped.step_dt, 0.01)

    def test_an_episode_that_ends_shows_its_last_observation_and_the_next_ones_first(self):
        settings = {"episode.length_s": 0.3, "episode.soft_reset_share": 0.0, "noise.level_high": 0.0}
        envs = VectorEnv(num_envs=64, settings=settings, curriculum=False)
        envs.reset()
        actions, ended = np.zeros((64, 12), np.float32), 0
        before = None
        for _ in range(30):
            observation, _, terminated, truncated, info = envs.step(actions)
            mask = info["_final_obs"]
            np.testing.assert_array_equal(mask, terminated | truncated)
            np.testing.assert_array_equal(info["reset"], mask)
            if before is not None and truncated.any():
                # In 10 ms a robot hardly moves; a new start is elsewhere.
                last, new = info["final_obs"][truncated], observation[truncated]
                self.assertLess(np.abs(last - before[truncated])[:, 9:21].max(), 1.0)
                self.assertGreater(np.abs(new - last).max(axis=1).min(), 1e-3)
                self.assertTrue(np.isfinite(info["final_privileged"][truncated]).all())
                ended += truncated.sum()
            before = observation.copy()
        self.assertGreater(ended, 0)

    def test_the_terms_make_the_reward(self):
        envs = VectorEnv(num_envs=64, curriculum={"transitions": 0.0})
        _, reward, terminated, _, info = envs.step(np.zeros((64, 12), np.float32))
        total = sum(term.astype(np.float64) for term in info["reward_terms"].values())
        alive = ~terminated
        np.testing.assert_allclose(reward[alive], 0.05 * np.maximum(total, 0.0)[alive], atol=1e-5)

    def test_the_curriculum_stays_where_it_is_put(self):
        held = {"speed_mps": 2.0, "ground": 0.5, "transitions": 2e6, "late": 0.25}
        envs = VectorEnv(num_envs=64, curriculum=held, settings=["learner.window=4"])
        for _ in range(8):
            envs.step(np.zeros((64, 12), np.float32))
        self.assertEqual(envs.curriculum, held)
        self.assertIn("reward_velocity", envs.statistics)

    def test_actions_in_joints_move_the_joints(self):
        settings = {"noise.level_high": 0.0, "noise.joint_offset_rad": 0.0}
        envs = VectorEnv(num_envs=64, settings=settings, curriculum=False)
        actions = np.zeros((64, 12), np.float32)
        actions[:, 1] = 1.0
        quiet = VectorEnv(num_envs=64, settings=settings, curriculum=False)
        for _ in range(6):
            moved, still = envs.step(actions)[0], quiet.step(np.zeros_like(actions))[0]
        change = (envs.raw_observation(moved) - quiet.raw_observation(still))[:, 9:21]
        self.assertGreater(np.median(change[:, 1]), 0.05)
        self.assertLess(np.abs(np.median(change[:, 4])), 0.03)

    def test_spaces_hold_what_goes_in_and_out(self):
        envs = VectorEnv(num_envs=64)
        observation, _ = envs.reset()
        self.assertTrue(envs.observation_space.contains(observation))
        self.assertEqual(envs.single_action_space.shape, (12,))
        envs.step(envs.action_space.sample())


if __name__ == "__main__":
    unittest.main()
