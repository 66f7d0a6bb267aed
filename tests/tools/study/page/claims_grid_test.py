# SPDX-License-Identifier: BSD-3-Clause
"""Verdicts of the claims about the grid, on made-up measurements."""
import unittest

import numpy as np

from controllers import GRID
from evidence import Evidence, Group
from made_up import straight_runs, verdict


def on_grid(reward=4.0, lost=0.1, slope_m=-0.020, clearance_m=0.03, lower_cells=0, cells=100, slope_spread_m=0.001):
    """This mean reward on the stiffest three quarters of the cells, the share `lost` less on the
    softest; the same slope of clearance for both stiffnesses; in `lower_cells` 1 less reward and 10
    mm less clearance."""
    cell, side = np.arange(cells), np.tile([1.0, -1.0], 8)
    soft, lower = cell < cells // 4, cell < lower_cells
    return [Group("grid", "cells", lists={"static_depth_m": 0.05 - 1e-4 * cell,
                                          "reward": reward * np.where(soft, 1.0 - lost, 1.0) - lower,
                                          "clearance_m": clearance_m - 0.01 * lower}),
            Group("grid", "robots", runs={"reward": reward + 0.5 * side,
                                          "slope_flat_m": slope_m + slope_spread_m * side,
                                          "slope_cone_m": slope_m + slope_spread_m * side})]


class GridVerdicts(unittest.TestCase):
    def expect(self, text, claim_id, alive=16, **controllers):
        """`controllers`: arguments of on_grid, for seeds 1 and 2 alike."""
        names = {name.replace("_", "-"): arguments for name, arguments in controllers.items()}
        home = straight_runs("own", (1.0, 2.0, 3.0), alive=alive)
        evidence = Evidence({
            "E7": {name: dict.fromkeys((1, 2), on_grid(**arguments)) for name, arguments in names.items()},
            "fairness": dict.fromkeys(names, dict.fromkeys((1, 2), home))})
        self.assertEqual(verdict(claim_id, evidence), text)

    def test_reward_is_lost_on_soft_ground(self):
        for rigid, pl_rigid, text in ((0.5, 0.41, "agrees"), (0.5, 0.35, "can't tell"), (0.5, 0.05, "can't tell"),
                                      (0.05, 0.1, "contradicts")):
            self.expect(text, "52", ours={"lost": 0.1}, env_rigid={"lost": rigid}, pl_rigid={"lost": pl_rigid})

    def test_clearance_of_the_rigid_ones_adapts_less(self):
        for rigid, pl_rigid, text in ((-0.009, 0.009, "agrees"), (-0.009, -0.015, "can't tell"),
                                      (-0.03, -0.025, "contradicts")):
            self.expect(text, "53", ours={}, env_rigid={"slope_m": rigid}, pl_rigid={"slope_m": pl_rigid})

    def test_clearance_of_the_tcn_adapts_less(self):
        for slope_m, text in ((-0.009, "agrees"), (-0.015, "can't tell"), (-0.021, "contradicts")):
            self.expect(text, "58", ours={}, tcn={"slope_m": slope_m})

    def test_clearance_adapts_if_it_is_higher_on_softer_ground(self):
        for slope_m, spread_m, text in ((-0.006, 0.001, "agrees"), (-0.004, 0.001, "can't tell"),
                                        (0.006, 0.001, "can't tell"), (-0.006, 0.1, "contradicts")):
            self.expect(text, "54", ours={}, pl_gm={"slope_m": slope_m, "slope_spread_m": spread_m})

    def test_cells_are_counted(self):
        for better, text in ((95, "agrees"), (94, "can't tell"), (50, "can't tell"), (49, "contradicts")):
            self.expect(text, "55", ours={"reward": 3.5, "lost": 0.0}, pl_gm={"lost": 0.0, "lower_cells": better})
        for lower, text in ((95, "agrees"), (60, "can't tell"), (10, "contradicts")):
            self.expect(text, "56", ours={"lower_cells": lower}, pl_gm={})

    def test_a_grid_of_another_size_tells_nothing_of_its_cells(self):
        for claim_id in ("52", "53", "54", "55", "56", "58"):
            self.expect("can't tell (too few runs)", claim_id, ours={"reward": 5.0, "cells": 4}, pl_gm={"cells": 4},
                        env_rigid={"lost": 0.9, "cells": 4}, pl_rigid={"lost": 0.9, "cells": 4},
                        tcn={"slope_m": 0.0, "cells": 4})

    def test_the_recurrent_one_has_more_reward(self):
        for ours, tcn, text in ((4.1, 4.0, "agrees"), (4.0, 4.0, "can't tell"), (4.0, 4.1, "contradicts")):
            self.expect(text, "57", ours={"reward": ours}, tcn={"reward": tcn})
        self.expect("can't tell (not run)", "57", ours={})

    def test_the_teacher_is_below_three_others(self):
        for oracle_o, text in ((4.1, "agrees"), (4.0, "can't tell"), (3.9, "contradicts")):
            self.expect(text, "60", teacher_gm={}, ours={"reward": 4.1}, oracle_h={"reward": 4.2},
                        oracle_o={"reward": oracle_o})

    def test_one_oracle_is_the_best_of_all(self):
        # 4.1 is 2.5 % above.
        for oracle_h, tcn, alive, text in ((4.2, 4.0, 16, "agrees"), (4.1, 4.0, 16, "can't tell"),
                                           (4.2, 4.3, 16, "can't tell"), (3.9, 4.0, 16, "contradicts"),
                                           (4.2, 4.0, 14, "can't tell (not competently trained)")):
            rewards = {key.replace("-", "_"): {} for key in GRID}
            self.expect(text, "61", alive, **{**rewards, "oracle_h": {"reward": oracle_h}, "tcn": {"reward": tcn}})

    def test_the_other_oracle_is_like_ours(self):
        for oracle_o, text in ((4.1, "agrees"), (3.8, "can't tell"), (4.3, "contradicts")):
            self.expect(text, "62", ours={}, oracle_o={"reward": oracle_o})

    def test_the_student_is_below_its_teacher(self):
        self.expect("agrees", "68", pl_gm={}, teacher_gm={})
        self.expect("contradicts", "68", pl_gm={"reward": 4.1}, teacher_gm={})


if __name__ == "__main__":
    unittest.main()
