# SPDX-License-Identifier: BSD-3-Clause
"""Verdicts of the claims about recovery, turns and other grounds, on made-up measurements."""
import math
import unittest

from controllers import COMMANDS
from made_up import (GROUNDS, TURNED, everything, foam, hidden_states, on_other_grounds, recovery, straight_runs, turns,
                     verdict)


class GroundVerdicts(unittest.TestCase):
    def expect(self, claim_id, text, **measured):
        """`measured`: groups by experiment and controller, such as E3_ours; all else is alike."""
        evidence = everything()
        for name, groups in measured.items():
            experiment, _, controller = name.partition("_")
            evidence.measured[experiment][controller.replace("_", "-")] = {1: groups, 2: groups}
        with self.subTest(claim_id):
            self.assertEqual(verdict(claim_id, evidence), text)

    def grounds(self, ground, **figures):
        """E3 with these figures on one ground."""
        return ([g for one in GROUNDS for g in straight_runs(one, COMMANDS, **(figures if one == ground else {}))] +
                [g for one in TURNED for g in turns(one)])

    def test_turns(self):
        for claim_id in ("2", "34"):
            for yaw, alive, text in ((0.93, 16, "agrees"), (0.93, 15, "can't tell"), (0.7, 16, "can't tell"),
                                     (0.6, 16, "contradicts")):
                self.expect(claim_id, text, E3_ours=[g for one in TURNED for g in turns(one, yaw=yaw, alive=alive)])

    def test_onto_wet_sand(self):
        for alive, after, text in ((14, 2.2, "agrees"), (13, 2.0, "can't tell"), (16, 1.0, "can't tell"),
                                   (7, 2.0, "contradicts")):
            self.expect("4", text, E2_ours=recovery(alive, after=after))

    def test_recovery(self):
        for alive, time_s, text in ((14, 0.9, "agrees"), (14, 1.5, "can't tell"), (14, 2.1, "contradicts"),
                                    (7, 0.5, "contradicts")):
            self.expect("6", text, E2_ours=recovery(alive, time_s))
        half_never, none_meet = recovery(14, 0.9), recovery(14, 0.9)
        half_never[0].runs["recovery_s"][:9] = math.nan
        none_meet[0].runs["met"][:] = 0.0
        self.expect("6", "contradicts", E2_ours=half_never)
        self.expect("6", "can't tell (no run met the strip)", E2_ours=none_meet)
        for ratio, text in ((1.3, "agrees"), (1.1, "can't tell"), (0.9, "contradicts")):
            self.expect("7", text, E2_ours=recovery(swing_ratio=ratio))

    def test_top_speeds(self):
        for claim_id, ground, top_mps in (("31", "grass", 3.13), ("32", "athletic-track", 3.62), ("33", "vinyl", 3.76)):
            for factor, text in ((1.1, "agrees"), (1.2, "can't tell"), (0.6, "contradicts")):
                self.expect(claim_id, text, E3_ours=self.grounds(ground, top_mps=factor * top_mps))

    def test_comparable_speeds(self):
        self.expect("35", "agrees")
        self.expect("35", "can't tell", E3_env_rigid=self.grounds("grass", speed_mps={v: 0.8 * v for v in COMMANDS}))
        # No success on one ground alone is no contradiction, on two it is.
        self.expect("35", "can't tell", E3_env_rigid=self.grounds("grass", successes=0))
        self.expect("35", "contradicts", E3_env_rigid=on_other_grounds(0))

    def test_the_size_of_an_excess(self):
        for claim_id, ground, excess in (("36", "athletic-track", 0.065), ("37", "grass", 0.112)):
            for factor, text in ((1.0, "agrees"), (0.4, "same direction, other size"), (2.2, "same direction, other size"),
                                 (-1.0, "contradicts")):
                self.expect(claim_id, text, E3_ours=self.grounds(ground, top_mps=3.0 * (1.0 + factor * excess)))
            self.expect(claim_id, "can't tell")

    def test_env_rigid_on_grass(self):
        for fast, text in ((2.9, "agrees"), (3.1, "can't tell"), (3.2, "contradicts")):
            self.expect("38", text, E3_env_rigid=self.grounds("grass", speed_mps={3.5: fast, "else": 3.0}))
        self.expect("38", "agrees", E3_env_rigid=self.grounds("grass", successes={3.5: 0, "else": 16}))
        for successes, text in ((8, "agrees"), (12, "can't tell"), (15, "contradicts")):
            self.expect("39", text, E3_env_rigid=self.grounds("grass", successes={4.0: successes, "else": 16}))
        for iqr_m, text in ((0.061, "agrees"), (0.055, "can't tell"), (0.05, "contradicts")):
            self.expect("39a", text, E3_env_rigid=self.grounds("grass", iqr_m={3.5: iqr_m, "else": 0.05}))

    def test_the_same_on_vinyl(self):
        for top_mps, text in ((3.05, "agrees"), (3.2, "can't tell"), (3.4, "contradicts")):
            self.expect("40", text, E3_ours=self.grounds("vinyl", top_mps=top_mps))

    def test_comparable_cost(self):
        for one, text in ((0.52, "agrees"), (0.6, "contradicts")):
            self.expect("41", text, E3_ours=on_other_grounds(cot=one))
        self.expect("41", "can't tell", E3_ours=self.grounds("grass", cot=0.6))

    def test_steep_cost(self):
        steep, flat = {4.0: 0.65, "else": 0.5}, 0.5
        for track, grass, text in ((steep, steep, "agrees"), (steep, flat, "can't tell"), (flat, flat, "contradicts")):
            groups = [g for one, cot in zip(GROUNDS, (flat, track, grass)) for g in straight_runs(one, COMMANDS, cot=cot)]
            self.expect("42", text, E3_ours=groups)

    def test_sensitivity_of_the_cost_is_of_common_grounds(self):
        self.expect("43", "can't tell")
        self.expect("43", "agrees", E3_env_rigid=self.grounds("grass", cot=0.6))
        self.expect("43", "contradicts", E3_ours=self.grounds("grass", cot=0.6))
        # Ours is dear on sand, where Env-Rigid has no success: not in common.
        self.expect("43", "agrees", E1_ours=straight_runs("beach", COMMANDS, cot=2.0),
                    E1_env_rigid=straight_runs("beach", COMMANDS, successes=0), E3_env_rigid=self.grounds("grass", cot=0.6))
        # One command has few successes: not in common, on either side.
        few = self.grounds("grass", cot={1.0: 5.0, "else": 0.5}, successes={1.0: 7, "else": 16})
        self.expect("43", "can't tell", E3_ours=few)

    def test_hidden_states(self):
        for apart, ground, phase in ((8.0, "agrees", "agrees"), (0.0, "contradicts", "contradicts")):
            self.expect("44", ground, E4_ours=hidden_states(apart))
            self.expect("45", phase, E4_ours=hidden_states(apart))

    def test_turns_on_the_mattress(self):
        for claim_id, rate, x in (("46", 1.0, 0.71), ("47", 2.0, 1.54)):
            for factor, text in ((1.2, "agrees"), (1.4, "can't tell"), (1.6, "contradicts")):
                self.expect(claim_id, text, E5_ours=turns("air-mattress", rate, yaw=factor * x))

    def test_the_only_one_that_turns(self):
        good, bad = turns("air-mattress"), turns("air-mattress", successes=4)
        self.expect("48", "agrees", E5_env_rigid=bad, E5_pl_gm=bad, E5_pl_rigid=bad)
        self.expect("48", "can't tell", E5_ours=good)
        self.expect("48", "contradicts", E5_ours=bad)

    def test_half_turns_of_pl_rigid(self):
        for successes, text in ((0, "agrees"), (1, "can't tell"), (8, "contradicts")):
            self.expect("49", text, E5_pl_rigid=turns("air-mattress", successes=successes))

    def test_turns_of_others_are_dear(self):
        for cotu, text in ((1.3, "agrees"), (1.1, "can't tell"), (0.9, "contradicts")):
            dear = turns("air-mattress", cotu=cotu)
            self.expect("50", text, E5_env_rigid=dear, E5_pl_gm=dear)
        # The claim has both turn.
        self.expect("50", "can't tell (no successful run)", E5_env_rigid=turns("air-mattress", successes=0),
                    E5_pl_gm=turns("air-mattress", cotu=1.3))

    def test_foam(self):
        for alive, text in ((15, "agrees"), (14, "can't tell"), (7, "contradicts")):
            self.expect("51", text, E6_ours=foam(alive))

    def test_the_cost_of_turning_is_of_the_seeds_that_turn(self):
        for cotu, text in ((1.4, "agrees"), (1.1, "can't tell")):
            evidence = everything()
            evidence.measured["E5"]["env-rigid"] = {1: turns("air-mattress", successes=0),
                                                    2: turns("air-mattress", cotu=cotu)}
            evidence.measured["E5"]["pl-gm"] = dict.fromkeys((1, 2), turns("air-mattress", cotu=1.4))
            self.assertEqual(verdict("50", evidence), text)


if __name__ == "__main__":
    unittest.main()
