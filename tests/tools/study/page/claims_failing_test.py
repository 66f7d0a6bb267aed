# SPDX-License-Identifier: BSD-3-Clause
"""Every rule where a controller fails everything, on made-up measurements."""
import re
import unittest

import claims
from controllers import BEACH
from made_up import everything, judgement, verdict


class AControllerThatFailsEverything(unittest.TestCase):
    def test_no_rule_breaks_down_whoever_fails(self):
        for failing in ((), *((c,) for c in BEACH), tuple(BEACH[1:]), tuple(BEACH)):
            for claim, found in claims.judge_all(everything(failing)):
                with self.subTest(claim.id, failing=failing):
                    self.assertNotIn(found.reason, ("not run", "too few runs", claims.NOT_COMPETENT))
                    self.assertIsNone(re.search(r"\b(nan|inf)\b", str(found) + " " + found.ours), found.ours)

    def expect(self, failing, **verdicts):
        evidence = everything(failing)
        for claim_id, text in verdicts.items():
            with self.subTest(claim_id):
                self.assertEqual(verdict(claim_id[1:], evidence), text)

    def test_both_rigid_ones(self):
        # All others are alike, so what needs a difference among them can't be told.
        self.expect(("env-rigid", "pl-rigid"), _9="same direction, other size", _22="same direction, other size",
                    _15="can't tell", _17="can't tell", _18="same direction, other size", _21="can't tell",
                    _23="can't tell (no successful run)", _24="can't tell (no successful run)",
                    _35="contradicts", _36="same direction, other size", _38="can't tell (no successful run)",
                    _39="agrees", _39a="can't tell (no successful run)", _40="contradicts",
                    _41="can't tell (no successful run)", _43="can't tell (fewer than two grounds in common)",
                    _48="can't tell", _49="agrees", _50="can't tell (no successful run)", _52="can't tell", _53="can't tell")

    def test_one_of_two_that_are_compared(self):
        self.expect(("env-rigid",), _24="contradicts")
        self.expect(("pl-rigid",), _24="same direction, other size")
        self.expect(("pl-gm",), _13="same direction, other size", _14="contradicts", _15="contradicts",
                    _19="same direction, other size", _50="can't tell (no successful run)")

    def test_ours(self):
        self.expect(("ours",), _1="contradicts", _4="contradicts", _6="contradicts", _8="contradicts", _9="contradicts",
                    _18="contradicts", _19="contradicts", _21="contradicts", _31="contradicts", _36="contradicts",
                    _44="can't tell (too few states)", _45="can't tell (too few states)", _48="contradicts",
                    _51="contradicts", _69="contradicts")

    def test_all_rivals(self):
        self.expect(tuple(BEACH[1:]), _17="can't tell", _20="can't tell (no successful run)", _21="agrees",
                    _69="agrees")

    def test_it_is_named(self):
        evidence = everything(("env-rigid", "pl-rigid"))
        self.assertIn("no successful run, so slowest: Env-Rigid, PL/Env-Rigid", judgement("17", evidence).ours)
        self.assertIn("against no successful run m/s", judgement("18", evidence).ours)


if __name__ == "__main__":
    unittest.main()
