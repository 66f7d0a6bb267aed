# SPDX-License-Identifier: BSD-3-Clause
"""The terms of CLAIMS.md on made-up figures."""
import math
import unittest

import numpy as np

import paper
import terms
from evidence import Value, median


def made_up(*values, scatter=0.01):
    """A value for each seed, eight runs scattered around it."""
    return {seed: Value(v, v + scatter * (np.arange(8) % 3 - 1)) for seed, v in enumerate(values, 1)}


class Above(unittest.TestCase):
    def test_needs_every_pair_of_seeds(self):
        self.assertTrue(terms.above(made_up(3.0, 2.9), made_up(2.0, 2.1)).holds)
        self.assertFalse(terms.above(made_up(3.0, 2.0), made_up(2.0, 2.1)).holds)

    def test_needs_its_margin(self):
        self.assertTrue(terms.above(made_up(3.0), made_up(2.0), 0.9).holds)
        self.assertFalse(terms.above(made_up(3.0), made_up(2.0), 1.1).holds)
        self.assertTrue(terms.above_by_share(made_up(3.0), made_up(2.0), 0.4).holds)
        self.assertFalse(terms.above_by_share(made_up(3.0), made_up(2.0), 0.6).holds)
        self.assertTrue(terms.below_by_share(made_up(2.0), made_up(3.0), 0.3).holds)
        self.assertFalse(terms.below_by_share(made_up(2.0), made_up(3.0), 0.4).holds)

    def test_needs_a_paired_difference_that_is_not_chance(self):
        a = made_up(3.5)  # the means differ by 0.5, the differences of single runs scatter by 3
        a[1].runs += np.tile([3.0, -3.0], 4)
        self.assertFalse(terms.above(a, made_up(3.0)).holds)

    def test_needs_eight_pairs_of_runs(self):
        a, b = made_up(3.0), made_up(2.0)
        self.assertEqual(terms.above(a, b).pairs, 8)
        a[1].runs[4] = math.nan
        self.assertEqual(terms.above(a, b).pairs, 7)
        self.assertFalse(terms.above(a, b).holds)

    def test_uses_the_runs_of_the_first_common_seed(self):
        a, b = made_up(3.0, 3.0), made_up(2.0, 2.0)
        del a[1]
        b[1].runs[:] = 100.0
        self.assertTrue(terms.above(a, b).holds)


class WithoutASuccess(unittest.TestCase):
    def none(self, worst):
        return {1: Value(worst, succeeded=False)}

    def test_the_worst_is_below_any_speed_and_above_any_cost(self):
        self.assertTrue(terms.above(made_up(3.0), self.none(0.0)).holds)
        self.assertFalse(terms.above(self.none(0.0), made_up(3.0)).holds)
        self.assertTrue(terms.below_by_share(made_up(3.0), self.none(math.inf), 0.1).holds)
        self.assertFalse(terms.below_by_share(self.none(math.inf), made_up(3.0), 0.1).holds)

    def test_the_other_side_needs_eight_runs(self):
        few = made_up(3.0)
        few[1].runs[0] = math.nan
        self.assertFalse(terms.above(few, self.none(0.0)).holds)
        self.assertEqual(terms.above(few, self.none(0.0)).pairs, 7)

    def test_two_without_are_not_compared(self):
        for worst in (0.0, math.inf):
            found = terms.above(self.none(worst), self.none(worst))
            self.assertTrue(found.none)
            self.assertFalse(found.holds)

    def test_it_is_said_in_words(self):
        self.assertEqual(terms.printed(self.none(math.inf)), "no successful run")
        self.assertEqual(terms.percent(self.none(0.0)), "no successful run")
        self.assertEqual(terms.printed({**made_up(3.0), 2: Value(math.inf, succeeded=False)}), "none [3.00, none]")


class Terms(unittest.TestCase):
    def test_about_is_15_percent_and_far_is_30_of_every_seed(self):
        self.assertTrue(terms.is_about(made_up(1.14), 1.0))
        self.assertFalse(terms.is_about(made_up(1.16), 1.0))
        self.assertFalse(terms.is_far_from(made_up(1.29), 1.0))
        self.assertTrue(terms.is_far_from(made_up(1.31), 1.0))
        self.assertFalse(terms.is_far_from(made_up(1.31, 1.2), 1.0))
        self.assertTrue(terms.is_about(made_up(0.76), 1.0, 0.25))

    def test_share_is_15_points_and_far_is_30_of_every_seed(self):
        self.assertTrue(terms.is_share(made_up(0.5), 0.375))
        self.assertFalse(terms.is_share(made_up(0.6), 0.375))
        self.assertFalse(terms.is_far_from_share(made_up(0.6), 0.375))
        self.assertTrue(terms.is_far_from_share(made_up(0.7), 0.375))

    def test_a_figure_that_a_seed_lacks_has_no_median(self):
        self.assertTrue(math.isnan(median(made_up(1.0, math.nan))))
        self.assertTrue(math.isnan(median({})))
        self.assertFalse(terms.is_about(made_up(math.nan), 1.0))
        self.assertFalse(terms.is_far_from({}, 1.0))
        self.assertEqual(median(made_up(3.0, 1.0, 2.0)), 2.0)

    def test_tolerances_are_half_or_twice_as_wide_and_as_they_are_afterwards(self):
        for width, about, share, excess in ((0.5, False, False, False), (1.0, True, True, False), (2.0, True, True, True)):
            with terms.tolerances(width):
                self.assertEqual(terms.is_about(made_up(1.1), 1.0), about)
                self.assertEqual(terms.is_share(made_up(0.6), 0.5), share)
                self.assertEqual(terms.is_excess(0.3, 0.1), excess)
        self.assertFalse(terms.is_excess(0.3, 0.1))
        self.assertTrue(terms.is_excess(0.2, 0.1))

    def test_the_interval_of_a_rate_is_wilsons(self):
        low, high = terms.rate_interval([1.0] * 9 + [0.0, math.nan])
        self.assertAlmostEqual(low, 0.5958, 4)
        self.assertAlmostEqual(high, 0.9821, 4)
        self.assertTrue(math.isnan(terms.rate_interval([math.nan])[0]))

    def test_figures_are_printed_with_their_range_over_seeds(self):
        self.assertEqual(terms.printed(made_up(1.25)), "1.25")
        self.assertEqual(terms.printed(made_up(0.3, 0.1, 0.2), 100.0, 0), "20 [10, 30]")
        self.assertEqual(terms.printed(made_up(math.nan)), "not defined")

    def test_the_interval_of_a_mean_is_students(self):
        n, low, high = terms.mean_interval([1.0, 2.0, 3.0, math.nan, 4.0])
        self.assertEqual(n, 4)
        self.assertAlmostEqual(high - 2.5, 3.18245 * math.sqrt(5 / 3 / 4), 4)
        self.assertAlmostEqual(low + high, 5.0)
        self.assertEqual(terms.mean_interval([math.nan])[0], 0)

    def test_kendalls_tau_is_1_for_the_same_order_and_minus_1_for_the_reverse(self):
        self.assertEqual(terms.kendall_tau([1, 2, 3, 4], [10, 20, 30, 40]), 1.0)
        self.assertEqual(terms.kendall_tau([1, 2, 3, 4], [4, 3, 2, 1]), -1.0)
        self.assertAlmostEqual(terms.kendall_tau([1, 2, 3, 4], [2, 1, 3, 4]), 4 / 6)
        self.assertAlmostEqual(terms.kendall_tau([1, 2, math.nan], [1, 2, 3]), 1 / 3)


class Paper(unittest.TestCase):
    def test_top_speeds_of_table_1_give_the_ratios_of_the_text(self):
        top = {key: row.top_mps for key, row in paper.BEACH.items()}
        self.assertAlmostEqual(top["ours"] / top["pl-rigid"] - 1.0, paper.FASTER_THAN_PL_RIGID, delta=0.0005)
        self.assertAlmostEqual(top["ours"] / top["pl-gm"] - 1.0, paper.FASTER_THAN_PL_GM, delta=0.0005)

    def test_success_rates_are_whole_trials_of_40(self):
        for key, row in paper.BEACH.items():
            if not math.isnan(row.success):
                self.assertAlmostEqual(40 * row.success, round(40 * row.success), msg=key)


if __name__ == "__main__":
    unittest.main()
