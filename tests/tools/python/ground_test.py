# SPDX-License-Identifier: BSD-3-Clause
"""Ground: the contact law under a simulator that is not ours."""

import csv
import os
import pathlib
import tempfile
import unittest

import numpy as np

from sandrunner import Ground, terrain_preset_names

GOLDEN = pathlib.Path(os.environ["SANDRUNNER_ROOT"], "tests/golden/drop.csv")
TYRE = {"foot_radius_m": 0.0295, "foot_width_m": 0.025}


def one(x=0.0, y=0.0, z=0.0):
    return np.array([[x, y, z]])


class GranularGround(unittest.TestCase):
    def test_falling_masses_match_those_of_an_independent_simulation(self):
        for row in csv.DictReader(GOLDEN.read_text().splitlines()):
            v = {key: float(value) for key, value in row.items()}
            if v["filter"] == 0.0 or v["centre_height_m"] > 0.1:
                continue  # the others take as long, and say the same
            with self.subTest(row=row):
                inertia = v["inertia"] == 1.0
                ground = Ground("dry-sand", {"terrain.sigma_flat_npm3": 1e6 * v["sigma_flat_mnpm3"],
                                             "terrain.sigma_cone_npm3": 1e6 * v["sigma_cone_mnpm3"],
                                             "terrain.effects.inertial_drag": inertia,
                                             "terrain.effects.added_mass": inertia}, **TYRE)
                contacts, dt = ground.contacts(1), v["dt_s"]
                z, speed, deepest, peak = v["centre_height_m"] - 0.0295, 0.0, 0.0, 0.0
                for _ in range(round(0.5 / dt)):
                    force = ground.step(contacts, one(z=z), one(z=speed), dt)["normal"][0]
                    peak = max(peak, force)
                    speed += dt * (force / 5.0 - 9.81)
                    z += dt * speed
                    deepest = max(deepest, -z)
                self.assertAlmostEqual(1e3 * deepest, v["max_depth_mm"], delta=0.3)
                self.assertAlmostEqual(peak, v["peak_force_n"], delta=2e-3 * v["peak_force_n"])

    def test_a_foot_that_rises_is_pushed_no_more_until_it_is_as_deep_again(self):
        ground = Ground("dry-sand", {"terrain.effects.filter": False}, **TYRE)
        contacts, dt = ground.contacts(1), 2.5e-4
        down = [ground.step(contacts, one(z=-0.1 * k * dt), one(z=-0.1), dt)["normal"][0] for k in range(400)]
        deepest = 0.1 * 399 * dt
        self.assertGreater(down[-1], 10.0)
        up = ground.step(contacts, one(z=-deepest + 0.001), one(z=0.1), dt)
        self.assertEqual(up["normal"][0], 0.0)
        again = ground.step(contacts, one(z=-deepest + 0.001), one(z=-0.1), dt)
        self.assertEqual(again["normal"][0], 0.0)
        deeper = ground.step(contacts, one(z=-deepest - 1e-5), one(z=-0.1), dt)
        self.assertAlmostEqual(deeper["normal"][0], down[-1], delta=0.1 * down[-1])
        self.assertAlmostEqual(contacts["memory_depth"][0], deepest + 1e-5)

    def test_a_foot_in_the_air_feels_nothing(self):
        ground = Ground()
        forces = ground.step(ground.contacts(2), np.array([[0, 0, 0.01], [1, 0, 0.5]]), np.zeros((2, 3)), 2.5e-4)
        self.assertEqual([forces[name].any() for name in forces.dtype.names], [False] * 4)

    def test_each_foot_has_its_own_memory(self):
        ground, dt = Ground(**TYRE), 2.5e-4
        together, alone = ground.contacts(2), ground.contacts(1)
        for k in range(100):
            z = np.array([[0.0, 0.0, -2e-4 * k], [0.3, 0.0, 0.05 - 6e-4 * k]])
            speed = np.array([[0.0, 0.0, -0.8], [0.0, 0.0, -2.4]])
            pair = ground.step(together, z, speed, dt)
            single = ground.step(alone, z[1:], speed[1:], dt)
            self.assertEqual(pair[1], single[0])


class FlatSole(unittest.TestCase):
    def test_its_patches_bear_what_it_bears_on_one_point(self):
        sole = dict(foot_radius_m=0.01, foot_length_m=0.1, foot_width_m=0.08)
        whole, patches = Ground(**sole), Ground(**sole, foot_patches=4)
        alone, four = whole.contacts(1), patches.contacts(4)
        for k in range(1, 50):
            z = np.array([[0.0, 0.0, -2e-4 * k]])
            speed = np.array([[0.0, 0.0, -0.8]])
            expected = whole.step(alone, z, speed, 2.5e-4)["normal"][0]
            each = patches.step(four, z.repeat(4, 0), speed.repeat(4, 0), 2.5e-4)["normal"]
            np.testing.assert_allclose(each, expected / 4.0)
        self.assertGreater(expected, 100.0)  # an area 40 times that of a ball of 1 cm
        with self.assertRaisesRegex(ValueError, "foot_width_m: found 0, expected that of a sole"):
            Ground(foot_length_m=0.1)


class OtherGrounds(unittest.TestCase):
    def test_springs_push_as_they_are_stiff_and_never_pull(self):
        ground = Ground("memory-foam", {"terrain.kind": "linear", "terrain.stiffness_npm": 5000.0,
                                        "terrain.damping_nspm": 100.0, "terrain.friction": 0.5,
                                        "terrain.coupling_npm": 0.0})
        position, velocity = np.zeros((3, 3)), np.zeros((3, 3))
        position[:, 2] = -0.01
        velocity[:, 2] = (0.0, -0.1, 9.0)
        forces = ground.step(ground.contacts(3), position, velocity, 1e-3)
        np.testing.assert_allclose(forces["normal"], [50.0, 60.0, 0.0])
        np.testing.assert_allclose(forces["friction_bound"], [25.0, 30.0, 0.0])

    def test_presets_that_yield_each_have_a_law(self):
        laws = 0
        for name in terrain_preset_names():
            try:
                Ground(name)
                laws += 1
            except ValueError as error:
                self.assertRegex(str(error), "is hard|couples")
        self.assertGreaterEqual(laws, 3)

    def test_a_file_of_patches_gives_each_foot_the_ground_where_it_touched_down(self):
        text = ('[terrain]\nname = "two"\nkind = "linear"\nstiffness_npm = 1000.0\ndamping_nspm = 0.0\n'
                "[[terrain.patch]]\nfrom_x_m = 1.0\nstiffness_npm = 3000.0\n")
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "two.toml")
            path.write_text(text)
            ground = Ground(path)
        position = np.array([[0.0, 0.0, -0.01], [2.0, 0.0, -0.01]])
        forces = ground.step(ground.contacts(2), position, np.zeros((2, 3)), 1e-3)
        np.testing.assert_allclose(forces["normal"], [10.0, 30.0])


if __name__ == "__main__":
    unittest.main()
