# SPDX-License-Identifier: BSD-3-Clause
"""Verdicts on made-up measurements of the robot half, and the table of claims."""
import unittest

import claims
from evidence import Evidence
from made_up import on_the_beach, oracle, straight_runs, verdict


class Verdicts(unittest.TestCase):
    def expect(self, text, claim_ids, **controllers):
        for claim_id in claim_ids.split():
            with self.subTest(claim_id):
                names = {name.replace("_", "-"): arguments for name, arguments in controllers.items()}
                self.assertEqual(verdict(claim_id, on_the_beach(names)), text)

    def test_a_rule_that_holds_agrees(self):
        self.expect("agrees", "1 8", ours={"top_mps": 3.1})

    def test_the_opposite_contradicts(self):
        self.expect("contradicts", "1 8", ours={"successes": 13, "top_mps": 1.0})

    def test_between_the_two_nothing_can_be_told(self):
        self.expect("can't tell", "1 8", ours={"successes": 15, "top_mps": 2.4})

    def test_what_the_simulation_lacks_is_not_testable(self):
        self.expect("not testable in simulation", "5 11 30")

    def test_one_seed_is_said_behind_the_verdict(self):
        self.expect("agrees (1 seed)", "1", ours={"seeds": [1]})

    def test_a_missing_model_is_not_run(self):
        self.expect("can't tell (not run)", "9 18 66", ours={})  # 66: no benchmark

    def test_fewer_than_eight_runs_are_too_few(self):
        self.expect("can't tell (too few runs)", "1", ours={"runs": 7, "successes": 7})

    def test_fewer_than_eight_pairs_are_too_few(self):
        self.expect("can't tell (too few runs)", "18", ours={}, pl_rigid={"successes": 7, "top_mps": 1.65})
        self.expect("agrees", "18", ours={}, pl_rigid={"successes": 8, "top_mps": 1.65})

    def test_a_controller_that_falls_on_its_own_ground_is_not_competent(self):
        self.expect("can't tell (not competently trained)", "1", ours={"alive_at_home": 14})
        self.expect("agrees", "1", ours={"alive_at_home": 15})

    def test_excess_agrees_from_half_to_twice_and_contradicts_the_other_way_round(self):
        for other_mps, text in ((2.0, "agrees"),  # 50 % faster, the paper 50.7 %
                                (2.9, "same direction, other size"),  # 3 %
                                (1.2, "same direction, other size"),  # 150 %
                                (3.2, "contradicts")):
            self.expect(text, "19", ours={}, pl_gm={"top_mps": other_mps})

    def test_a_rival_without_a_success_is_slower(self):
        self.expect("same direction, other size", "18", ours={}, pl_rigid={"successes": 0})
        self.expect("contradicts", "18", ours={"successes": 0}, pl_rigid={})
        self.expect("can't tell (no successful run)", "18", ours={"successes": 0}, pl_rigid={"successes": 0})

    def test_the_benchmark_of_contact_models_is_judged(self):
        for ratio, text in ((20.0, "agrees"), (8.0, "can't tell"), (4.0, "contradicts")):
            contact = {"ratio": ratio, "spread_cone": 0.42, "spread_drft": 0.39, "spread_planar": 0.40}
            self.assertEqual(verdict("66", Evidence({}, contact)), text)
            self.assertEqual(verdict("67", Evidence({}, contact)), "agrees")


class Claims(unittest.TestCase):
    def test_every_claim_has_a_rule_or_is_not_testable(self):
        found = claims.read_claims(claims.CLAIMS_FILE.read_text())
        self.assertEqual(len(found), 71)
        self.assertEqual(set(claims.RULES), {c.id for c in found if c.agrees_if != claims.NOT_TESTABLE})
        self.assertEqual(next(c for c in found if c.id == "39a").section, "Other grounds")

    def test_the_table_is_read_as_it_is_written(self):
        found = claims.read_claims(
            "| verdict | meaning |\n|---|---|\n| agrees | yes |\n\n## Part\n"
            "| id | the paper | our figure | agrees if | contradicts if |\n|---|---|---|---|---|\n"
            "| 1 | \"a\" | b | c | |\n\ntext\n")
        self.assertEqual(found, [claims.Claim("1", '"a"', "b", "c", "", "Part")])

    def test_quotes_are_doubled_in_the_csv(self):
        row = claims.Claim("1", '"a", b', "c", "d", "", "Part"), claims.Judgement(ours="1.0")
        self.assertEqual(claims.claims_csv([row]).splitlines()[1], '1,"""a"", b","c","d","","1.0","can\'t tell"')


class OracleVerdicts(unittest.TestCase):
    def expect(self, text, claim_id, **oracles):
        evidence = Evidence({"E8": {}, "fairness": {}})
        for name, groups in oracles.items():
            evidence.measured["E8"][f"oracle-{name}"] = {1: groups}
            evidence.measured["fairness"][f"oracle-{name}"] = {1: straight_runs("own", (1.0, 2.0, 3.0))}
        self.assertEqual(verdict(claim_id, evidence), text)

    def test_the_estimate_has_to_count_twice_as_much_as_the_terrain_in_both(self):
        twice, once, less = oracle(estimate=0.3), oracle(estimate=0.15), oracle(estimate=0.05)
        self.expect("agrees (1 seed)", "59", h=twice, o=twice)
        self.expect("can't tell (1 seed)", "59", h=twice, o=once)
        self.expect("can't tell (1 seed)", "59", h=less, o=once)
        self.expect("contradicts (1 seed)", "59", h=less, o=less)

    def test_with_the_history_the_terrain_has_to_count_less(self):
        little, much = oracle(terrain=0.1), oracle(terrain=0.2)
        self.expect("agrees (1 seed)", "63", h=little, o=much)
        self.expect("can't tell (1 seed)", "63", h=much, o=much)
        self.expect("contradicts (1 seed)", "63", h=much, o=little)

    def test_without_the_history_the_terrain_has_to_count_more_unevenly(self):
        even, little, much = (oracle(bins=bins) for bins in ((0.9, 1.0, 1.1), (0.89, 1.0, 1.11), (0.5, 1.0, 1.5)))
        self.expect("agrees (1 seed)", "64", h=even, o=much)
        self.expect("can't tell (1 seed)", "64", h=even, o=little)
        self.expect("contradicts (1 seed)", "64", h=much, o=little)

    def test_both_stiffnesses_have_to_count_more_than_the_inertia(self):
        self.expect("agrees (1 seed)", "65", h=oracle(), o=oracle(gradients=(0.3, 0.2, 0.1)))
        self.expect("can't tell (1 seed)", "65", h=oracle(), o=oracle(gradients=(0.3, 0.1, 0.2)))
        self.expect("contradicts (1 seed)", "65", h=oracle(), o=oracle(gradients=(0.1, 0.2, 0.3)))

    def test_a_missing_oracle_is_not_run(self):
        self.expect("can't tell (not run)", "59", h=oracle())
        self.expect("can't tell (not run)", "65", h=oracle())


if __name__ == "__main__":
    unittest.main()
