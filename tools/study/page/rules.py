# SPDX-License-Identifier: BSD-3-Clause
"""What the rules of rules_*.py share: what a rule sees of the evidence, and the list of all
rules."""
from dataclasses import dataclass
from typing import Callable

import terms
from evidence import greatest_of_first_five, mean_value, median, run_values, select
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
    """What a rule sees of the evidence. Remembers comparisons that rest on too few pairs of
    runs."""

    def __init__(self, evidence):
        self.evidence, self.too_few = evidence, False

    def holds(self, comparison):
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
        return (self.above(a, b) and 0.5 * x <= found <= 2.0 * x, self.above(b, a),
                f"{printed(a)} against {printed(b)} {unit}: {100 * found:+.1f} %")

    def straight(self, controller, ground, low, high, of):
        """A figure of runs on a ground in E1 ("beach") or E3, at commands from `low` to `high`."""
        return self.evidence.figure("E1" if ground == "beach" else "E3", controller,
                                    lambda g: of(select(g, ground, "", low, high)))

    def all_runs(self, controller, ground, low, high, name):
        return self.straight(controller, ground, low, high, lambda g: mean_value(g, name))

    def success(self, controller, ground="beach", low=0.5, high=4.0):
        return self.all_runs(controller, ground, low, high, "success")

    def mean(self, controller, ground, low, high, name):
        """Mean of successful runs."""
        return self.straight(controller, ground, low, high, lambda g: mean_value(g, name, True))

    def top_speed(self, controller, ground="beach"):
        return self.straight(controller, ground, 0.0, 10.0, lambda g: greatest_of_first_five(g, "end_speed_mps"))

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
