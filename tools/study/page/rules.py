# SPDX-License-Identifier: BSD-3-Clause
"""What the rules of rules_*.py share: what a rule sees of the evidence, and the list of all
rules."""
import math
from dataclasses import dataclass
from typing import Callable

import terms
from evidence import greatest_of_first_five, mean_value, median, or_worst, run_values, select, success_rate
from terms import LEAST_PAIRS, printed

RULES = {}  # by the id of a claim


@dataclass(frozen=True)
class Rule:
    experiments: list
    controllers: list  # all of them have to be trained competently
    # Of a Case: whether the claim agrees, whether it is contradicted, our figures as text.
    judge: Callable


def rule(claim, experiments, controllers):
    """Registers the function below it; several experiments or controllers are separated by
    spaces."""
    def register(judge):
        RULES[claim] = Rule(experiments.split(), controllers.split(), judge)
        return judge
    return register


class Case:
    """What a rule sees of the evidence. Remembers comparisons that rest on too few pairs of runs,
    whether a claim of a size has the paper's direction, and why nothing can be told."""

    def __init__(self, evidence):
        self.evidence, self.too_few, self.same_direction, self.reason = evidence, False, False, ""

    def holds(self, comparison):
        if comparison.none:
            self.reason = terms.NO_SUCCESS
        self.too_few = self.too_few or comparison.pairs < LEAST_PAIRS
        return comparison.holds

    def above(self, a, b):
        return self.holds(terms.above(a, b))

    def above_by_share(self, a, b, share):
        return self.holds(terms.above_by_share(a, b, share))

    def below_by_share(self, a, b, share):
        return self.holds(terms.below_by_share(a, b, share))

    def excess(self, a, b, x, unit="m/s"):
        """ "excess x" of a over b."""
        found = terms.excess(a, b)
        self.same_direction = self.above(a, b)
        self.needs_success(found)
        return (self.same_direction and terms.is_excess(found, x), self.above(b, a),
                f"{printed(a)} against {printed(b)} {unit}" + (f": {100 * found:+.1f} %" if math.isfinite(found) else ""))

    def needs_success(self, *values):
        """Says why, if one of these is not defined for want of a successful run."""
        if any(math.isnan(value) for value in values):
            self.reason = terms.NO_SUCCESS

    def nothing_to_compare(self, *controllers, grounds=("beach",)):
        """Says why two controllers never have eight successes at the same command."""
        self.too_few = True
        if not all(any(median(self.success(c, ground)) for ground in grounds) for c in controllers):
            self.reason = terms.NO_SUCCESS

    def straight(self, controller, ground, low, high, of):
        """A figure of runs on a ground in E1 ("beach") or E3, at commands from `low` to `high`."""
        return self.evidence.figure("E1" if ground == "beach" else "E3", controller,
                                    lambda g: of(select(g, ground, "", low, high)))

    def all_runs(self, controller, ground, low, high, name):
        return self.straight(controller, ground, low, high, lambda g: mean_value(g, name))

    def success(self, controller, ground="beach", low=0.5, high=4.0):
        return self.straight(controller, ground, low, high, success_rate)

    def success_text(self, controller, ground="beach", low=0.5, high=4.0):
        """As the paper counted, and with all runs and every tick."""
        strict = self.straight(controller, ground, low, high, lambda g: success_rate(g, "strict_success"))
        return f"{terms.percent(self.success(controller, ground, low, high))} (strict: {terms.percent(strict)})"

    def mean(self, controller, ground, low, high, name, worst=math.nan):
        """Mean of successful runs; of a seed without any, `worst`."""
        return self.straight(controller, ground, low, high, lambda g: or_worst(mean_value(g, name, True), worst))

    def speed(self, controller, ground, command):
        return self.mean(controller, ground, command, command, "speed_mps", 0.0)

    def cost(self, controller, ground, low, high):
        return self.mean(controller, ground, low, high, "cot", math.inf)

    def top_speed(self, controller, ground="beach"):
        return self.straight(controller, ground, 0.0, 10.0,
                             lambda g: or_worst(greatest_of_first_five(g, "end_speed_mps"), 0.0))

    def turn(self, experiment, controller, ground, rate, name):
        """Mean over turns of both ways."""
        def both(groups):
            return mean_value([g for way in (rate, -rate) for g in select(groups, ground, "turn", way, way)], name)
        return self.evidence.figure(experiment, controller, both)

    def both_succeed(self, a, b, ground, command):
        """Whether both have eight successes at a command."""
        counts = [self.straight(c, ground, command, command, lambda g: (run_values(g[:1], "success") == 1.0).sum())
                  for c in (a, b)]
        return all(median(count) >= 8 for count in counts)
