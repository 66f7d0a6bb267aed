# SPDX-License-Identifier: BSD-3-Clause
"""The rules of CLAIMS.md, "Dry sand" and "All of it"."""
import math

import numpy as np

import paper
from controllers import BEACH, COMMANDS, name_of
from evidence import NAN, Value, mean, mean_value, median, nearest_to, or_worst, run_values
from rules import rule
from terms import (NO_SUCCESS, is_about, is_far_from, is_far_from_share, is_share, kendall_tau, number, percent,
                   printed, values_of)

SIX = " ".join(BEACH)
OTHERS = BEACH[1:]
SLOWEST, FASTEST = 0.5, 4.0  # m/s, commands


def failures(groups, name):
    """A figure in the runs without success, also those that do not count."""
    return run_values(groups, name)[run_values(groups, "success") != 1.0]


def at_one_mps(case, controller, name):
    """A figure at the command whose average speed is nearest to 1 m/s; infinite without a successful
    run."""
    def at_nearest(groups):
        nearest = nearest_to(groups, 1.0)
        return or_worst(mean_value([nearest], name, True), math.inf) if nearest else Value(math.inf, succeeded=False)
    return case.straight(controller, "beach", SLOWEST, FASTEST, at_nearest)


@rule("1", "E1", "ours")
def top_speed(case):
    top, x = case.top_speed("ours"), paper.BEACH["ours"].top_mps
    return is_about(top, x), is_far_from(top, x), printed(top) + " m/s"


@rule("3", "E1", "ours")
def sinking(case):
    depth = case.all_runs("ours", "beach", 2.5, 3.5, "depth_m")
    return median(depth) >= 0.059, median(depth) < 0.040, printed(depth, 1e3, 1) + " mm"


@rule("8", "E1", "ours")
def no_failure(case):
    share = case.success("ours")
    return all(v >= 0.97 for v in values_of(share)), median(share) < 0.90, case.success_text("ours")


def success(case, controller):
    """Against the success rate that the paper prints, all of which are below that of Ours."""
    share, x = case.success(controller), paper.BEACH[controller].success
    case.same_direction = median(case.success("ours")) - median(share) > 0.15
    return (is_share(share, x), is_far_from_share(share, x) and not case.same_direction,
            f"{case.success_text(controller)}; Ours {percent(case.success('ours'))}")


rule("9", "E1", "ours pl-rigid")(lambda case: success(case, "pl-rigid"))
rule("13", "E1", "ours pl-gm")(lambda case: success(case, "pl-gm"))
rule("22", "E1", "ours env-rigid")(lambda case: success(case, "env-rigid"))


@rule("10", "E1", "pl-rigid")
def pl_rigid_bell(case):
    slow, middle, fast = (median(case.success("pl-rigid", "beach", *ends))
                          for ends in ((0.5, 1.5), (2.0, 2.5), (3.0, 4.0)))
    return (middle - slow >= 0.25 and middle - fast >= 0.25, middle <= slow and middle <= fast,
            f"{100 * slow:.0f}, {100 * middle:.0f}, {100 * fast:.0f} %")


@rule("12", "E1", "pl-rigid")
def pl_rigid_hind_feet(case):
    ratio = case.straight("pl-rigid", "beach", 3.0, FASTEST, lambda g: mean(failures(g, "hind_over_front")))
    if math.isnan(median(ratio)):
        case.reason = "no failed run"
    return median(ratio) > 1.2, median(ratio) < 1.0, printed(ratio)


@rule("14", "E1", "pl-gm")
def pl_gm_slow(case):
    share = case.success("pl-gm", "beach", 0.5, 2.5)
    return median(share) == 1.0, median(share) < 72 / 80, case.success_text("pl-gm", "beach", 0.5, 2.5)


@rule("15", "E1", SIX)
def pl_gm_clearance(case):
    def iqr(controller):
        return case.straight(controller, "beach", 1.0, 2.0, lambda g: or_worst(
            mean_value([one for one in g if one.command != 1.5], "iqr_m", True), 0.0))
    mine, others = iqr("pl-gm"), [iqr(c) for c in BEACH if c != "pl-gm"]
    above = [case.above_by_share(mine, other, 0.2) for other in others]
    middle = median([median(other) for other in others])
    return (all(above), median(mine) < middle,
            f"{printed(mine, 1e3, 1)} mm; median of the others {number(middle, 1e3, 1)}")


@rule("16", "E1", "ours pl-gm")
def pl_gm_limits(case):
    pl, ours = (case.all_runs(c, "beach", 3.0, FASTEST, "limit_alone") for c in ("pl-gm", "ours"))
    return median(pl) >= 0.2, median(pl) <= median(ours), f"{percent(pl)}; Ours {percent(ours)}"


@rule("17", "E1", SIX)
def order_of_speeds(case):
    tau = kendall_tau([median(case.top_speed(c)) for c in paper.BEACH], [row.top_mps for row in paper.BEACH.values()])
    none = [name_of(c) for c in paper.BEACH if not median(case.top_speed(c))]
    return (tau >= 0.6, tau <= 0.0,
            f"tau {tau:.2f}" + (f"; {NO_SUCCESS}, so slowest: {', '.join(none)}" if none else ""))


def faster_than(case, other, x):
    return case.excess(case.top_speed("ours"), case.top_speed(other), x)


rule("18", "E1", "ours pl-rigid")(lambda case: faster_than(case, "pl-rigid", paper.FASTER_THAN_PL_RIGID))
rule("19", "E1", "ours pl-gm")(lambda case: faster_than(case, "pl-gm", paper.FASTER_THAN_PL_GM))


@rule("20", "E1", "ours pl-gm pl-rigid")
def cheaper_than_pl(case):
    lower, higher = [], 0
    for other in ("pl-gm", "pl-rigid"):
        for v in COMMANDS:
            if case.both_succeed("ours", other, "beach", v):
                a, b = (case.mean(c, "beach", v, v, "cot") for c in ("ours", other))
                higher += median(a) > median(b)
                lower.append(case.below_by_share(a, b, 0.1))
    if not lower:
        case.nothing_to_compare("ours", "pl-gm", "pl-rigid")
    return (bool(lower) and all(lower), 2 * higher > len(lower), f"higher in {higher} of {len(lower)} comparisons")


@rule("21", "E1", SIX)
def peak_torques(case):
    below_all, above_median, texts = True, True, []
    for name in ("peak_hfe_nm", "peak_kfe_nm"):
        ours, others = at_one_mps(case, "ours", name), [at_one_mps(case, other, name) for other in OTHERS]
        below = [case.above(other, ours) for other in others]
        middle = median([median(other) for other in others])
        below_all = below_all and all(below)
        above_median = above_median and median(ours) > middle
        texts.append(f"{printed(ours, 1.0, 1)} N m; median of the others {number(middle, 1.0, 1)}")
    return below_all, above_median, "; ".join(texts)


@rule("23", "E1", "env-rigid")
def env_rigid_fails_fast(case):
    def difference(groups):
        commands = np.array([[g.command] * len(g.runs["success"]) for g in groups])
        succeeded = run_values(groups, "success") == 1.0
        return mean(commands[~succeeded]) - mean(commands[succeeded])
    figure = case.straight("env-rigid", "beach", SLOWEST, FASTEST, difference)
    share = case.success("env-rigid")
    if math.isnan(median(figure)):
        case.reason = NO_SUCCESS if any(v == 0.0 for v in values_of(share)) else "no failed run"
    return median(figure) >= 0.5, median(figure) < 0.0, printed(figure) + " m/s"


@rule("24", "E1", "env-rigid pl-rigid")
def extension_power(case):
    return case.excess(at_one_mps(case, "pl-rigid", "extension_w"), at_one_mps(case, "env-rigid", "extension_w"),
                       paper.EXTENSION_EXCESS, "W")


@rule("25", "E1", "env-quasistatic")
def quasistatic_completes(case):
    shares = [median(case.success("env-quasistatic", "beach", v, v)) for v in (1.0, 1.5, 2.0, 2.5, 3.0)]
    return (all(share >= 15 / 16 for share in shares), sum(share < 12 / 16 for share in shares) >= 2,
            ", ".join(f"{100 * share:.0f}" for share in shares) + " %")


@rule("26", "E1", "env-quasistatic")
def quasistatic_fails_fast(case):
    share = case.success("env-quasistatic", "beach", 3.5, FASTEST)
    return median(share) <= 0.5, median(share) >= 0.9, case.success_text("env-quasistatic", "beach", 3.5, FASTEST)


@rule("27", "E1", "ours env-quasistatic")
def quasistatic_cost(case):
    theirs, ours = (case.cost(c, "beach", 1.0, 3.0) for c in ("env-quasistatic", "ours"))
    ratio = np.float64(median(theirs)) / median(ours)
    case.needs_success(ratio)
    return 0.85 <= ratio < 1.0, ratio > 1.0, f"{printed(theirs, 1.0, 3)}; Ours {printed(ours, 1.0, 3)}"


@rule("28", "E1", SIX)
def linear_success(case):
    agrees, _, text = success(case, "env-linear")
    case.same_direction = False  # the claim is of an order
    share = median(case.success("env-linear"))
    lower = sum(median(case.success(other)) < share for other in BEACH if other != "env-linear")
    return agrees and lower == 0, lower >= 2, text


@rule("29", "E1", "env-linear")
def linear_falls(case):
    falls = case.straight("env-linear", "beach", SLOWEST, FASTEST, lambda g: mean(failures(g, "alive") == 0.0))
    if math.isnan(median(falls)):
        case.reason = "no failed run"
    return median(falls) >= 0.5, median(falls) < 0.25, percent(falls)


@rule("69", "E1", SIX)
def outperforms(case):
    counts = []  # of each other controller and figure: at how many commands it is better
    for other in OTHERS:
        counts += [sum(median(case.success(other, "beach", v, v)) > median(case.success("ours", "beach", v, v))
                       for v in COMMANDS),
                   sum(median(case.speed(other, "beach", v)) > median(case.speed("ours", "beach", v))
                       for v in COMMANDS),
                   sum(median(case.cost(other, "beach", v, v)) < median(case.cost("ours", "beach", v, v))
                       for v in COMMANDS)]
    return (sum(counts) == 0, 2 * max(counts) > len(COMMANDS),
            f"another one is better in {sum(counts)} comparisons; in one figure at up to {max(counts)} of "
            f"{len(COMMANDS)} commands")


@rule("70", "E1", "env-rigid env-quasistatic env-linear")
def ablations_help_little(case):
    rigid, linear, quasistatic = (median(case.success(c)) for c in ("env-rigid", "env-linear", "env-quasistatic"))
    linear, quasistatic = linear - rigid, quasistatic - rigid
    return (linear < 0.25 and quasistatic < 0.25, linear > 0.5 and quasistatic > 0.5,
            f"{100 * linear:+.0f} and {100 * quasistatic:+.0f} points")
