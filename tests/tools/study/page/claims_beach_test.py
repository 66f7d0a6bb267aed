# SPDX-License-Identifier: BSD-3-Clause
"""Verdicts of the claims about dry sand, on made-up measurements. claims_test.py has 1, 8, 18 and
19."""
import unittest

import numpy as np

from controllers import COMMANDS
from made_up import everything, judgement, straight_runs, verdict


def by_command(function):
    return {v: function(v) for v in COMMANDS}


class BeachVerdicts(unittest.TestCase):
    def expect(self, claim_id, text, **controllers):
        """`controllers`: arguments of straight_runs; the others are all alike."""
        evidence = everything()
        for name, arguments in controllers.items():
            groups = straight_runs("beach", COMMANDS, **arguments)
            evidence.measured["E1"][name.replace("_", "-")] = {1: groups, 2: groups}
        with self.subTest(claim_id, controllers=controllers):
            self.assertEqual(verdict(claim_id, evidence), text)

    def test_feet_sink_in(self):
        for depth_m, text in ((0.06, "agrees"), (0.05, "can't tell"), (0.03, "contradicts")):
            self.expect("3", text, ours={"depth_m": depth_m})

    def test_a_share_of_another_size_is_no_contradiction_below_ours(self):
        for claim_id, controller, successes in (("9", "pl_rigid", 6), ("13", "pl_gm", 12), ("22", "env_rigid", 8)):
            self.expect(claim_id, "agrees", **{controller: {"successes": successes}})
            self.expect(claim_id, "same direction, other size", **{controller: {"successes": 1}})
            self.expect(claim_id, "can't tell" if claim_id == "13" else "contradicts", **{controller: {"successes": 16}})
            # Ours as bad.
            self.expect(claim_id, "contradicts", ours={"successes": 0}, **{controller: {"successes": 0}})

    def test_the_bell(self):
        for slow, middle, fast, text in ((4, 16, 4, "agrees"), (14, 16, 4, "can't tell"), (16, 8, 16, "contradicts")):
            self.expect("10", text, pl_rigid={"successes": by_command(
                lambda v: slow if v < 2.0 else middle if v < 3.0 else fast)})

    def test_hind_feet_sink_deeper_in_failures(self):
        for ratio, text in ((1.3, "agrees"), (1.1, "can't tell"), (0.9, "contradicts")):
            self.expect("12", text, pl_rigid={"successes": 2, "hind_over_front": ratio})
        self.expect("12", "can't tell (no failed run)")

    def test_no_failure_of_pl_up_to_2_5(self):
        for successes, text in ((16, "agrees"), (15, "can't tell"), (14, "contradicts")):
            self.expect("14", text, pl_gm={"successes": by_command(lambda v: successes if v <= 2.5 else 0)})

    def test_pl_lifts_its_feet_highest(self):
        for iqr_m, text in ((0.061, "agrees"), (0.055, "can't tell"), (0.04, "contradicts")):
            self.expect("15", text, pl_gm={"iqr_m": iqr_m})
        self.expect("15", "agrees", pl_gm={"iqr_m": 0.061}, env_rigid={"successes": 0})

    def test_joint_limits_of_pl(self):
        for share, ours, text in ((0.25, 0.0, "agrees"), (0.1, 0.0, "can't tell"), (0.1, 0.1, "contradicts")):
            self.expect("16", text, pl_gm={"limit_alone": share}, ours={"limit_alone": ours})

    def test_the_order_of_top_speeds(self):
        order = ("ours", "pl_gm", "env_quasistatic", "env_linear", "pl_rigid", "env_rigid")
        falling = {c: {"top_mps": 3.0 - 0.2 * i} for i, c in enumerate(order)}
        self.expect("17", "agrees", **falling)
        self.expect("17", "agrees", **{**falling, "pl_rigid": {"successes": 0}, "env_rigid": {"successes": 0}})
        self.expect("17", "contradicts", **{c: {"top_mps": 1.0 + 0.2 * i} for i, c in enumerate(order)})

    def test_ours_is_cheaper_than_pl(self):
        for cost, text in ((0.6, "agrees"), (0.52, "can't tell"), (0.4, "contradicts")):
            self.expect("20", text, pl_gm={"cot": cost}, pl_rigid={"cot": cost})
        self.expect("20", "agrees", pl_gm={"cot": 0.6}, pl_rigid={"successes": 0})
        self.expect("20", "can't tell (too few runs)", pl_gm={"successes": 7}, pl_rigid={"successes": 7})

    def test_peak_torques(self):
        for torque, text in ((25.0, "agrees"), (30.0, "can't tell"), (35.0, "contradicts")):
            self.expect("21", text, ours={"peak_hfe_nm": torque, "peak_kfe_nm": torque})
        self.expect("21", "agrees", ours={"peak_hfe_nm": 25.0, "peak_kfe_nm": 25.0}, env_rigid={"successes": 0})

    def test_env_rigid_fails_fast(self):
        for successes, text in ((lambda v: 16 if v < 2.5 else 0, "agrees"), (lambda v: 8, "can't tell"),
                                (lambda v: 0 if v < 2.5 else 16, "contradicts")):
            self.expect("23", text, env_rigid={"successes": by_command(successes)})
        self.expect("23", "can't tell (no failed run)")

    def test_power_of_extension(self):
        for power_w, text in ((30.0, "agrees"), (22.0, "same direction, other size"), (20.0, "can't tell"),
                              (15.0, "contradicts")):
            self.expect("24", text, pl_rigid={"extension_w": power_w})

    def test_soil_without_inertia_up_to_3(self):
        for fast, slow, text in ((0, 16, "agrees"), (0, 14, "can't tell"), (16, 8, "contradicts")):
            self.expect("25", text, env_quasistatic={"successes": by_command(lambda v: slow if 1.0 <= v <= 3.0 else fast)})
        for fast, text in ((8, "agrees"), (12, "can't tell"), (15, "contradicts")):
            self.expect("26", text, env_quasistatic={"successes": by_command(lambda v: fast if v > 3.0 else 16)})

    def test_soil_without_inertia_is_a_little_cheaper(self):
        for cost, text in ((0.45, "agrees"), (0.4, "can't tell"), (0.55, "contradicts")):
            self.expect("27", text, env_quasistatic={"cot": cost})
        self.expect("27", "contradicts", env_quasistatic={"successes": 0})

    def test_springs_are_the_worst(self):
        self.expect("28", "agrees", env_linear={"successes": 3})
        self.expect("28", "can't tell", env_linear={"successes": 3}, env_rigid={"successes": 2})
        self.expect("28", "contradicts", env_linear={"successes": 3}, env_rigid={"successes": 0},
                    pl_rigid={"successes": 0})

    def test_springs_fall(self):
        for alive, text in ((4, "agrees"), (11, "can't tell"), (14, "contradicts")):
            self.expect("29", text, env_linear={"successes": 0, "alive": alive})
        self.expect("29", "can't tell (no failed run)")

    def test_none_is_better_than_ours_anywhere(self):
        self.expect("69", "agrees")
        self.expect("69", "can't tell", pl_gm={"cot": by_command(lambda v: 0.4 if v == 1.0 else 0.5)})
        self.expect("69", "contradicts", pl_gm={"cot": 0.4})

    def test_springs_and_soil_without_inertia_help_little(self):
        for successes, text in ((3, "agrees"), (7, "can't tell"), (9, "contradicts")):
            self.expect("70", text, env_rigid={"successes": 0}, env_linear={"successes": successes},
                        env_quasistatic={"successes": successes})

    def test_the_strict_figure_is_beside_and_has_no_part(self):
        evidence = everything()
        for group in evidence.measured["E1"]["ours"][1] + evidence.measured["E1"]["ours"][2]:
            group.runs["strict_success"] = np.zeros(16)
        found = judgement("8", evidence)
        self.assertEqual(found.verdict, "agrees")
        self.assertIn("100.0 [100.0, 100.0] % (strict: 0.0 [0.0, 0.0] %)", found.ours)


if __name__ == "__main__":
    unittest.main()
