# SPDX-License-Identifier: BSD-3-Clause
"""Batch: the simulator without a task."""

import unittest

import numpy as np

from sandrunner import Batch


class Standing(unittest.TestCase):
    def test_robots_stand_on_their_weight(self):
        batch = Batch(num_robots=16, ground="dry-sand")
        batch.advance(4000)
        batch.advance(400)
        height = batch.state["position"][:, 2]
        self.assertTrue(((height > 0.36) & (height < 0.48)).all(), height)
        weight = 9.81 * (batch.model["base"]["mass"] + sum(batch.model["legs"][part]["mass"].sum(axis=1)
                                                           for part in ("hip", "thigh", "shank")))
        np.testing.assert_allclose(batch.sums["foot_load"].sum(axis=1) / 400, weight, rtol=0.02)
        self.assertTrue((batch.report["penetration"] > 0).all())

    def test_joints_go_to_their_targets(self):
        batch = Batch(num_robots=8, ground="rigid")
        batch.drive["kp"] = 150.0
        batch.targets[:, 1] += 0.1
        before = batch.state["joint_position"][:, 1].copy()
        batch.advance(2000)
        self.assertTrue((batch.state["joint_position"][:, 1] - before > 0.05).all())

    def test_a_state_that_is_set_is_where_the_robot_goes_on(self):
        batch = Batch(num_robots=8)
        state = batch.state.copy()
        state["position"][3] = (5.0, -2.0, 2.0)
        batch.set_state(state[3:4], [3])
        batch.advance(400)  # 0.1 s
        moved = batch.state["position"]
        np.testing.assert_allclose(moved[3], [5.0, -2.0, 2.0 - 0.5 * 9.81 * 0.01], atol=2e-3)
        self.assertLess(np.abs(moved[2]).max(), 1.0)
        batch.stand([3])
        self.assertLess(abs(batch.state["position"][3, 0]), 1e-6)

    def test_a_heavier_robot_sinks_deeper_and_one_on_hard_ground_not(self):
        batch = Batch(num_robots=8)
        model = batch.model
        model["base"]["mass"][1] *= 2.0
        batch.set_model(model)
        np.testing.assert_array_equal(batch.model["base"]["mass"], model["base"]["mass"])
        batch.set_ground("rigid", robots=[2])
        batch.advance(4000)
        depth = batch.report["penetration"].mean(axis=1)
        self.assertGreater(depth[1], 1.2 * depth[0])
        self.assertLess(depth[2], 1e-3)

    def test_softer_settings_let_it_sink(self):
        soft = Batch(num_robots=8, settings={"terrain.sigma_cone_npm3": 0.1e6})
        hard = Batch(num_robots=8, settings={"terrain.sigma_cone_npm3": 0.6e6})
        for batch in (soft, hard):
            batch.advance(4000)
        self.assertGreater(soft.report["penetration"].mean(), hard.report["penetration"].mean() + 0.005)


def bytes_of_fields(dtype):
    """Bytes of all numbers in a record, but not of gaps between them."""
    if dtype.subdtype:
        return bytes_of_fields(dtype.subdtype[0]) * int(np.prod(dtype.shape))
    if dtype.names:
        return sum(bytes_of_fields(dtype[name]) for name in dtype.names)
    return dtype.itemsize


class Bits(unittest.TestCase):
    def test_every_number_of_a_robot_has_a_name(self):
        batch = Batch(num_robots=1)
        for array in (batch.state, batch.drive, batch.report, batch.sums, batch.model):
            self.assertEqual(bytes_of_fields(array.dtype), array.dtype.itemsize)

    def test_do_not_depend_on_the_number_of_threads(self):
        states = []
        for threads in (1, 2):
            batch = Batch(num_robots=100, threads=threads)
            random = np.random.default_rng(0)
            for _ in range(5):
                batch.targets[:] = batch.nominal_position_rad + 0.3 * random.standard_normal((100, 12))
                batch.advance(40)
            states.append(batch.state.tobytes())
        self.assertEqual(states[0], states[1])

    def test_arrays_stay_where_they_are(self):
        batch = Batch(num_robots=8)
        state, address = batch.state, batch.state.ctypes.data
        for _ in range(10):
            batch.advance(4)
        self.assertIs(batch.state, state)
        self.assertEqual(batch.state.ctypes.data, address)


if __name__ == "__main__":
    unittest.main()
