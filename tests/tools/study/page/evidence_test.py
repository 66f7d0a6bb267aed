# SPDX-License-Identifier: BSD-3-Clause
"""From results.json to figures, and what hidden states tell."""
import json
import math
import pathlib
import tempfile
import unittest

import numpy as np

import figures
import hidden_state
from evidence import (PARTS, Evidence, Group, greatest_of_first_five, grid_medians, load, mean_value, nearest_to,
                      or_worst, read_group, soft_and_stiff, success_rate)

NAN = math.nan


def group_of(command, success, speed):
    return Group("beach", "", command, {"success": np.array(success, float), "speed_mps": np.array(speed)})


class FiguresOfRuns(unittest.TestCase):
    def test_the_greatest_is_of_successful_runs_among_the_first_five(self):
        slow = group_of(1.0, [1, 1, 1, 1, 1, 1], [1.0, 1.1, 1.2, 1.0, 1.0, 5.0])
        fast = group_of(2.0, [0, 1, 1, 1, 1, 1], [9.0, 2.0, 2.1, 1.9, 2.0, 5.0])
        value = greatest_of_first_five([slow, fast], "speed_mps")
        self.assertEqual(value.value, 2.1)
        self.assertEqual(value.runs.tolist(), [1.0, 2.0, 2.1, 1.9, 2.0, 5.0])

    def test_means_of_successes_leave_out_the_other_runs(self):
        both = [group_of(1.0, [1, 0], [1.0, 7.0]), group_of(2.0, [1, 0], [3.0, NAN])]
        value = mean_value(both, "speed_mps", successes=True)
        self.assertEqual(value.value, 2.0)
        self.assertEqual(value.runs[0], 2.0)
        self.assertTrue(math.isnan(value.runs[1]))
        self.assertEqual(mean_value(both, "success").value, 0.5)
        self.assertTrue(math.isnan(mean_value([], "success").value))

    def test_success_is_what_a_log_shows_of_the_runs_that_begin_and_strictly_of_all(self):
        # Kept; past a stop for a tick, a step, a step before the line; fell there; only slow.
        runs = {"reached": [1, 1, 1, 1, 0, 0], "limits_kept": [1, 0, 0, 0, 0, 0], "stops_brief": [1, 1, 0, 0, 0, 0],
                "failed_before_track": [0, 0, 0, 1, 1, 0]}
        raw = {"scenario": "", "command": 1.0, "runs": runs, "lists": {}}
        for ground, success, limit in (("beach", [1, 1, 0, NAN, NAN, 0], [0, 0, 1, NAN, NAN, 0]),
                                       ("grass", [1, 1, 0, 0, 0, 0], [0, 0, 1, 1, 0, 0])):
            group = read_group({**raw, "ground": ground})
            np.testing.assert_array_equal(group.runs["success"], success)
            np.testing.assert_array_equal(group.runs["limit_alone"], limit)
            np.testing.assert_array_equal(group.runs["strict_success"], [1, 0, 0, 0, 0, 0])

    def test_each_command_counts_alike_and_one_without_a_run_that_counts_is_a_failure(self):
        half, all_of_two, none = (group_of(1.0, success, [1.0] * 4) for success in (
            [1, 0, 1, 0], [1, 1, NAN, NAN], [NAN] * 4))
        self.assertEqual(success_rate([half, all_of_two]).value, 0.75)
        self.assertEqual(success_rate([half, none]).value, 0.25)

    def test_without_a_success_a_figure_is_the_worst_that_there_is(self):
        none = or_worst(mean_value([group_of(1.0, [0, 0], [1.0, 1.0])], "speed_mps", True), 0.0)
        self.assertEqual((none.value, none.succeeded), (0.0, False))
        one = or_worst(mean_value([group_of(1.0, [0, 1], [1.0, 2.0])], "speed_mps", True), 0.0)
        self.assertEqual((one.value, one.succeeded), (2.0, True))

    def test_the_nearest_command_is_by_the_average_speed_of_its_successes(self):
        a, b = group_of(0.5, [1, 1], [0.9, 1.0]), group_of(1.0, [1, 1], [1.4, 1.4])
        none = group_of(1.5, [0, 0], [1.0, 1.0])
        self.assertIs(nearest_to([none, b, a], 1.0), a)
        self.assertIsNone(nearest_to([none], 1.0))

    def test_results_are_read_with_nan_for_null(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "results.json"
            path.write_text(json.dumps({**dict.fromkeys(PARTS), "runs": 2, "experiments": {"E5": {"ours": {"10": [
                {"ground": "grass", "scenario": "turn", "command": -1.0, "runs": {"cotu": [0.1, None]},
                 "lists": {"x": [1e-300]}}]}}}}))
            evidence, results = load(path)
        group = evidence.seeds("E5", "ours")[10][0]
        self.assertEqual((group.ground, group.scenario, group.command), ("grass", "turn", -1.0))
        self.assertEqual(group.runs["cotu"][0], 0.1)
        self.assertTrue(math.isnan(group.runs["cotu"][1]))
        self.assertEqual(group.lists["x"].tolist(), [1e-300])
        self.assertEqual(results["runs"], 2)
        self.assertEqual(evidence.seeds("E5", "env-rigid"), {})


def cells(depth, reward):
    return [Group("grid", "cells", lists={"static_depth_m": np.array(depth), "reward": np.array(reward, float)})]


class Grid(unittest.TestCase):
    def test_soft_and_stiff_are_quarters_by_static_depth(self):
        both = soft_and_stiff(cells([3, 1, 8, 4, 5, 6, 7, 2], [0, 4, 1, 0, 0, 0, 3, 6]), "reward")
        self.assertEqual(both, (2.0, 5.0))

    def test_medians_are_of_the_seeds_that_have_the_cell(self):
        self.assertEqual(len(grid_medians(Evidence(), "ours", "reward")), 0)
        seeds = {1: cells([1, 2], [1, NAN]), 2: cells([1, 2], [3, 5]), 3: cells([1, 2], [7, NAN])}
        self.assertEqual(grid_medians(Evidence({"E7": {"ours": seeds}}), "ours", "reward").tolist(), [3, 5])


class CostCurve(unittest.TestCase):
    def test_finds_the_curve_of_its_own_points(self):
        def truth(v):
            return 0.8 * np.exp(-1.3 * v) + 0.05 * v + 0.4
        x = np.arange(0.4, 4.0, 0.2)
        y = truth(x)
        y[3] = NAN
        np.testing.assert_allclose(figures.fit_cost(x, y)(x), truth(x), atol=1e-3)

    def test_refuses_fewer_than_five_points(self):
        x = np.arange(1.0, 6.0)
        self.assertIsNone(figures.fit_cost(x[:4], x[:4]))
        self.assertIsNone(figures.fit_cost(x, np.array([1, 2, NAN, 4, 5])))
        self.assertIsNotNone(figures.fit_cost(x, x))


class HiddenStates(unittest.TestCase):
    """Three clusters far apart in five dimensions, each of two runs on a ground of its own; the
    phase goes round along the last two."""

    def setUp(self):
        random = np.random.default_rng(1)
        cluster = np.arange(90) % 3
        self.run = 2 * cluster + np.arange(90) // 3 % 2
        self.ground = np.array([0, 0, 1, 1, 2, 2])
        self.phase = random.random(90)
        self.points = 8.0 * np.eye(3, 5)[cluster] + 0.3 * random.normal(size=(90, 5))
        self.points[:, 3:] = 2.0 * np.column_stack(
            [np.cos(2 * np.pi * self.phase), np.sin(2 * np.pi * self.phase)])

    def test_neighbours_are_of_other_runs(self):
        near = hidden_state.neighbours_in_other_runs(self.points, self.run, 4)
        self.assertEqual(near.shape, (90, 4))
        self.assertTrue((self.run[near] != self.run[:, None]).all())

    def test_clusters_tell_their_grounds_and_the_phase(self):
        near = hidden_state.neighbours_in_other_runs(self.points, self.run, 5)
        self.assertEqual(hidden_state.share_told(near, self.ground[self.run]), 1.0)
        self.assertGreater(hidden_state.phase_told(near, self.phase), 0.9)
        # Runs whose states lie among those of another ground tell that one.
        self.assertEqual(hidden_state.share_told(near, np.array([0, 1, 1, 2, 2, 0])[self.run]), 0.0)

    def test_of_a_tie_the_nearest_counts(self):
        near, ground = np.array([[1, 2]] * 3), np.array([7, 7, 8])
        self.assertEqual(hidden_state.share_told(near, ground), 2 / 3)

    def test_states_without_order_tell_nothing(self):
        near = hidden_state.neighbours_in_other_runs(np.random.default_rng(5).normal(size=(90, 5)), self.run)
        self.assertLess(hidden_state.share_told(near, self.ground[self.run]),
                        hidden_state.shuffled_share_told(near, self.run, self.ground) + 0.1)
        self.assertLess(hidden_state.phase_told(near, self.phase), 0.4)

    def test_random_numbers_are_those_of_the_simulator(self):
        # sim::random_uniform(1, 31, counter)
        for counter, value in ((5, 0.25040658647960923),):
            self.assertEqual(hidden_state.random_uniform(31, counter), value)


if __name__ == "__main__":
    unittest.main()
