# SPDX-License-Identifier: BSD-3-Clause
"""results.json, and the figures that rules, tables and pictures take from it."""
import json
import math
from dataclasses import dataclass, field

import numpy as np

NAN = math.nan
PARTS = {"build", "command", "runs", "grid_runs", "grid_cells", "models", "takes_part", "experiments", "contact",
         "recovery_run", "ground"}
np.seterr(divide="ignore", invalid="ignore")  # a mean of nothing is nan, which meets no rule


@dataclass
class Group:
    """Runs that differ only in start, random numbers and, on the beach, in the sand."""
    ground: str
    scenario: str = ""  # what else is particular
    command: float = 0.0  # m/s or rad/s
    # A figure's value in each run; nan where it is not defined.
    runs: dict = field(default_factory=dict)
    # Other arrays: a run over time, points of a picture.
    lists: dict = field(default_factory=dict)
    # Float32 numbers, little-endian, in base64.
    packed: dict = field(default_factory=dict)


@dataclass
class Value:
    """A figure of one training seed. Runs with the same place have the same start and noise for
    every controller."""
    value: float
    runs: np.ndarray = field(default_factory=lambda: np.array([]))
    succeeded: bool = True  # False: it has no successful run; `value` is the worst that there is


def median(values):
    """nan if there are none, or one of them is nan. A figure has the median of its seeds."""
    if isinstance(values, dict):
        values = [v.value for v in values.values()]
    return np.median(values) if len(values) else NAN


def mean(values, axis=None):
    """Mean of the values that are not nan; nan if there is none."""
    values = np.asarray(values, float)
    there = ~np.isnan(values)
    return np.where(there, values, 0.0).sum(axis) / there.sum(axis)


def select(groups, ground, scenario="", low=-math.inf, high=math.inf):
    """Those of this ground and scenario, with a command from `low` to `high`."""
    return [g for g in groups if g.ground == ground and g.scenario == scenario and low <= g.command <= high]


def run_values(groups, name, successes=False):
    """The figure in each run, a row for each group. `successes`: nan in runs without a success."""
    if not groups:
        return np.empty((0, 0))
    rows = np.array([g.runs[name] for g in groups], float)
    if successes:
        rows = np.where(np.array([g.runs["success"] for g in groups]) == 1.0, rows, NAN)
    return rows


def mean_value(groups, name, successes=False):
    """Mean over all runs of all groups; each run's mean over the groups."""
    rows = run_values(groups, name, successes)
    return Value(mean(rows), mean(rows, 0))


def success_rate(groups, name="success"):
    """Mean over the groups, each of which counts alike, as the paper's five trials a command. A
    group in which no run counts has none; each run's mean over the groups."""
    rows = run_values(groups, name)
    rates = [mean(row) if (~np.isnan(row)).any() else 0.0 for row in rows]
    return Value(mean(rates), mean(rows, 0))


def greatest_of_first_five(groups, name):
    """Greatest value of the successful runs among 0 to 4, as many as the paper has; each run's
    greatest."""
    runs = np.fmax.reduce(run_values(groups, name, True), axis=0, initial=NAN)
    return Value(np.fmax.reduce(runs[:5], initial=NAN), runs)


def or_worst(value, worst):
    """A seed's figure of its successful runs. Without one, a speed of 0 or a cost of infinity."""
    return Value(worst, succeeded=False) if np.isnan(value.runs).all() else value


def nearest_to(groups, speed_mps):
    """The group whose successful runs have the mean speed nearest to this; None: none has any."""
    off = [abs(mean_value([g], "speed_mps", True).value - speed_mps) for g in groups]
    return None if np.isnan(off).all() else groups[np.nanargmin(off)]


class Evidence:
    """measured[experiment][controller][seed]: groups of runs. `contact`: of sandrunner-bench
    contact, or None. `competent`: controllers that need no proof of it."""

    def __init__(self, measured=None, contact=None, competent=()):
        self.measured, self.contact, self.competent = measured or {}, contact, competent

    def seeds(self, experiment, controller):
        """Groups by seed; empty if it was not run."""
        return self.measured.get(experiment, {}).get(controller, {})

    def figure(self, experiment, controller, of):
        """{seed: Value}; `of` makes a Value or a number of a seed's groups."""
        made = {seed: of(groups) for seed, groups in self.seeds(experiment, controller).items()}
        return {seed: v if isinstance(v, Value) else Value(v) for seed, v in made.items()}

    def is_competent(self, controller):
        """Whether it survives at least 15 of 16 runs at 1, 2 and 3 m/s on the ground of its own
        training."""
        if controller in self.competent:
            return True
        alive = [self.figure("fairness", controller, lambda g: mean_value(select(g, "own", "", v, v), "alive"))
                 for v in (1.0, 2.0, 3.0)]
        return all(median(figure) >= 15 / 16 for figure in alive)


# E7: a group "cells" with a value for each cell, a group "robots" with means over the cells.

def grid_list(groups, name):
    return select(groups, "grid", "cells")[0].lists[name]


def grid_medians(evidence, controller, name):
    """Each cell's median over the seeds that have a value there; empty: not run."""
    cells = np.array([grid_list(g, name) for g in evidence.seeds("E7", controller).values()])
    return np.array([median(column[~np.isnan(column)]) for column in cells.T])


def grid_figure(evidence, controller, name):
    return evidence.figure("E7", controller, lambda g: mean_value(select(g, "grid", "robots"), name))


def soft_and_stiff(groups, name):
    """Mean over the softest and over the stiffest quarter of the cells, by static depth."""
    ordered = grid_list(groups, name)[np.argsort(-grid_list(groups, "static_depth_m"), kind="stable")]
    quarter = len(ordered) // 4
    return mean(ordered[:quarter]), mean(ordered[len(ordered) - quarter:])


# E8: experiments/oracles.h has the names of its numbers.

def oracle_ablation(evidence, oracle, group):
    return evidence.figure("E8", oracle, lambda g: mean_value(select(g, "training"), group))


def oracle_value(evidence, oracle, name, at=0):
    return evidence.figure("E8", oracle, lambda g: select(g, "training")[0].lists[name][at])


def add_success(group):
    """Success of a straight run as the paper counted it. A joint fails a run if it is past its stop
    for as long as a policy step, so that a log would show it. On the beach a run that fails before
    the start line has none: the paper's "were not recorded as a failure". `strict_success` counts
    all runs, and a joint past its stop in any tick."""
    runs = group.runs
    fails_uncounted = (runs["failed_before_track"] == 1.0) & (group.ground == "beach")
    runs["success"] = np.where(fails_uncounted, NAN, runs["reached"] * runs["stops_brief"])
    runs["limit_alone"] = np.where(fails_uncounted, NAN, runs["reached"] * (1.0 - runs["stops_brief"]))
    runs["strict_success"] = runs["reached"] * runs["limits_kept"]


def read_group(raw):
    # null becomes nan
    arrays = [{name: np.array(values, float) for name, values in raw[kind].items()} for kind in ("runs", "lists")]
    group = Group(raw["ground"], raw["scenario"], raw["command"], *arrays, raw.get("packed", {}))
    if "stops_brief" in group.runs:
        add_success(group)
    return group


def load(path):
    """The evidence in results.json, and all else in it. Raises ValueError for another file."""
    results = json.loads(path.read_text())
    if not isinstance(results, dict) or not PARTS <= results.keys():
        raise ValueError("not what sandrunner-study writes")
    measured = {experiment: {controller: {int(seed): [read_group(g) for g in groups] for seed, groups in seeds.items()}
                             for controller, seeds in controllers.items()}
                for experiment, controllers in results["experiments"].items()}
    return Evidence(measured, results["contact"]), results
