# SPDX-License-Identifier: BSD-3-Clause
"""The rules of CLAIMS.md for turns, transitions and "Other grounds", and for the contact models."""
import math

import numpy as np

import hidden_state
import paper
from controllers import COMMANDS, name_of
from evidence import mean, mean_value, median, select
from rules import rule
from terms import NO_SUCCESS, is_about, is_far_from, number, percent, printed

ENOUGH, FEW = 14 / 16, 8 / 16
HARDER = ("vinyl", "athletic-track", "grass")
GROUNDS = ("beach", *HARDER)


def recovery(case, scenario, command, name):
    """A figure of one group of E2."""
    return case.evidence.figure(
        "E2", "ours", lambda g: mean_value(select(g, "dry-sand", scenario, command, command), name))


def turns(case, grounds, x):
    """Turning at a rate of about x on each of these grounds, without a fall."""
    rates = {ground: case.turn("E3", "ours", ground, 1.0, "yaw_rate_radps") for ground in grounds}
    no_fall = all(median(case.turn("E3", "ours", ground, 1.0, "alive")) == 1.0 for ground in grounds)
    text = ", ".join(f"{ground} {printed(rate)}" for ground, rate in rates.items())
    return (all(is_about(rate, x) for rate in rates.values()) and no_fall,
            any(is_far_from(rate, x) for rate in rates.values()),
            text + " rad/s" + ("" if no_fall else ", with falls"))


rule("2", "E3", "ours")(lambda case: turns(case, ["dry-sand"], paper.YAW_SAND))
rule("34", "E3", "ours")(lambda case: turns(
    case, ["dry-sand", "wet-sand", "grass", "athletic-track", "vinyl"], paper.YAW_ALL))


@rule("4", "E2", "ours")
def onto_wet_sand(case):
    shares, ratios, texts = [], [], []
    for v in (2.0, 3.0, 4.0):
        alive, after, before = (recovery(case, "transition", v, name)
                                for name in ("alive", "speed_after_mps", "speed_before_mps"))
        shares.append(median(alive))
        ratios.append(median(after) / median(before))
        texts.append(f"{v:.0f} m/s: {percent(alive)} alive, {number(ratios[-1])}")
    return (all(s >= ENOUGH for s in shares) and all(0.9 <= r <= 1.15 for r in ratios),
            any(s < FEW for s in shares), "; ".join(texts))


@rule("6", "E2", "ours")
def stabilises(case):
    def median_time(groups):
        runs = select(groups, "dry-sand", "half")[0].runs
        times = runs["recovery_s"][runs["met"] == 1.0]
        return median(np.where(np.isnan(times), math.inf, times))  # inf: it falls, or stays slow
    alive, time_s = recovery(case, "half", 2.5, "alive"), case.evidence.figure("E2", "ours", median_time)
    if math.isnan(median(time_s)):
        case.reason = "no run met the strip"
    return (median(alive) >= ENOUGH and median(time_s) <= 1.0, median(alive) < FEW or median(time_s) > 2.0,
            f"{percent(alive)} alive, {printed(time_s)} s")


@rule("7", "E2", "ours")
def swings_high(case):
    ratio = recovery(case, "half", 2.5, "swing_ratio")
    return median(ratio) > 1.2, median(ratio) < 1.0, printed(ratio)


def top_speed_on(case, ground):
    top, x = case.top_speed("ours", ground), paper.TOP_MPS[ground]
    return is_about(top, x), is_far_from(top, x), printed(top) + " m/s"


rule("31", "E3", "ours")(lambda case: top_speed_on(case, "grass"))
rule("32", "E3", "ours")(lambda case: top_speed_on(case, "athletic-track"))
rule("33", "E3", "ours")(lambda case: top_speed_on(case, "vinyl"))


@rule("35", "E3", "ours env-rigid")
def comparable_speeds(case):
    offs, none = [], []  # without a success there is no speed to compare
    for ground in HARDER:
        for v in COMMANDS[:6]:
            a, b = (median(case.speed(c, ground, v)) for c in ("ours", "env-rigid"))
            if a and b:
                offs.append(abs(a / b - 1.0))
            else:
                none.append(f"{ground} at {v:.1f} m/s")
    apart = sum(off > 0.10 for off in offs) + len(none)
    return (not none and max(offs) <= 0.05, 2 * apart >= len(offs) + len(none),
            f"more than 10 % apart at {apart} of {len(offs) + len(none)} commands; " +
            (f"up to {100 * max(offs):.0f} %" if offs else "no speed in common") +
            (f"; {NO_SUCCESS} of one of them: {', '.join(none)}" if none else ""))


def faster_on(case, ground):
    return case.excess(case.top_speed("ours", ground), case.top_speed("env-rigid", ground),
                       1.0 / (1.0 - paper.RIGID_LOWER[ground]) - 1.0)


rule("36", "E3", "ours env-rigid")(lambda case: faster_on(case, "athletic-track"))
rule("37", "E3", "ours env-rigid")(lambda case: faster_on(case, "grass"))


@rule("38", "E3", "env-rigid")
def slower_when_commanded_more(case):
    slow, fast = (case.speed("env-rigid", "grass", v) for v in (3.0, 3.5))
    ratio = median(fast) / median(slow) if median(slow) else math.nan
    case.needs_success(ratio)
    return ratio < 1.0, ratio >= 1.05, f"{printed(fast)} after {printed(slow)} m/s"


@rule("39", "E3", "env-rigid")
def fails_on_grass(case):
    share = case.success("env-rigid", "grass", 4.0, 4.0)
    return median(share) <= 0.5, median(share) >= 0.9, case.success_text("env-rigid", "grass", 4.0, 4.0)


@rule("39a", "E3", "env-rigid")
def large_clearance(case):
    slow, fast = (case.mean("env-rigid", "grass", v, v, "iqr_m") for v in (3.0, 3.5))
    ratio = median(fast) / median(slow)
    case.needs_success(ratio)
    return ratio >= 1.2, ratio <= 1.0, f"{printed(fast, 1e3, 1)} after {printed(slow, 1e3, 1)} mm"


@rule("40", "E3", "ours env-rigid")
def same_on_vinyl(case):
    a, b = (case.top_speed(c, "vinyl") for c in ("ours", "env-rigid"))
    slower, faster = sorted((median(a), median(b)))
    off = faster / slower - 1.0 if slower else math.inf if faster else math.nan
    case.needs_success(off)
    return off <= 0.03, off > 0.10, f"{printed(a)} and {printed(b)} m/s"


@rule("41", "E1 E3", "ours env-rigid")
def comparable_cost(case):
    ratios = [median(case.mean("ours", ground, v, v, "cot")) / median(case.mean("env-rigid", ground, v, v, "cot"))
              for ground in GROUNDS for v in COMMANDS if case.both_succeed("ours", "env-rigid", ground, v)]
    if not ratios:
        case.nothing_to_compare("ours", "env-rigid", grounds=GROUNDS)
    worst, higher = max([0.0, *ratios]), sum(ratio > 1.0 for ratio in ratios)
    return (bool(ratios) and worst <= 1.05, 2 * higher > len(ratios),
            f"up to {worst:.2f}; above 1 in {higher} of {len(ratios)}")


@rule("42", "E3", "ours")
def steep_cost(case):
    rise = {ground: median(case.mean("ours", ground, 4.0, 4.0, "cot")) /
            median(case.mean("ours", ground, 2.5, 2.5, "cot")) for ground in HARDER}
    track, grass = rise["athletic-track"] / rise["vinyl"], rise["grass"] / rise["vinyl"]
    case.needs_success(track, grass)
    return (track >= 1.25 and grass >= 1.25, track <= 1.0 and grass <= 1.0,
            f"track {number(track)}, grass {number(grass)}")


@rule("43", "E1 E3", "ours env-rigid")
def insensitive_cost(case):
    # Both over the same: the commands at which both have eight successes, on grounds with one.
    common = {ground: [v for v in (1.0, 2.0, 3.0) if case.both_succeed("ours", "env-rigid", ground, v)]
              for ground in GROUNDS}
    common = {ground: commands for ground, commands in common.items() if commands}
    if len(common) < 2:
        case.reason = "fewer than two grounds in common"
        return False, False, ", ".join(common) or "none in common"

    def spread(controller):
        costs = [mean([median(case.cost(controller, ground, v, v)) for v in commands])
                 for ground, commands in common.items()]
        return max(costs) / min(costs)
    ours, rigid = spread("ours"), spread("env-rigid")
    return ours < rigid, ours > rigid, f"{ours:.2f}; Env-Rigid {rigid:.2f}; on {', '.join(common)}"


def no_states(case, told):
    if math.isnan(median(told)):
        case.reason = "too few states"


@rule("44", "E4", "ours")
def tells_the_ground(case):
    told, shuffled = (hidden_state.figure(case.evidence, name) for name in ("told", "told_shuffled"))
    no_states(case, told)
    return (median(told) >= 0.75 and median(told) > median(shuffled), median(told) <= median(shuffled),
            f"{percent(told)}; shuffled {percent(shuffled)}")


@rule("45", "E4", "ours")
def tells_the_phase(case):
    told = hidden_state.figure(case.evidence, "phase_told")
    no_states(case, told)
    return median(told) >= 0.8, median(told) < 0.4, printed(told)


def mattress_rate(case, command):
    rate, x = case.turn("E5", "ours", "air-mattress", command, "yaw_rate_radps"), paper.YAW_MATTRESS[command]
    return is_about(rate, x, 0.25), is_far_from(rate, x, 0.25), printed(rate) + " rad/s"


rule("46", "E5", "ours")(lambda case: mattress_rate(case, 1.0))
rule("47", "E5", "ours")(lambda case: mattress_rate(case, 2.0))


def turned(case, controller, runs_each_way):
    """Successes of the first runs each way."""
    return median(case.evidence.figure("E5", controller, lambda g: sum(
        select(g, "air-mattress", "turn", way, way)[0].runs["success"][:runs_each_way].sum() for way in (1.0, -1.0))))


@rule("48", "E5", "ours env-rigid pl-gm pl-rigid")
def only_one_that_turns(case):
    counts = {c: turned(case, c, 5) for c in ("ours", "env-rigid", "pl-gm", "pl-rigid")}
    ours = counts["ours"] == 10
    other = any(count == 10 for c, count in counts.items() if c != "ours")
    return (ours and not other, not ours and other,
            ", ".join(f"{name_of(c)} {count:.0f}" for c, count in counts.items()) + " of 10")


@rule("49", "E5", "pl-rigid")
def no_half_turn(case):
    count = turned(case, "pl-rigid", 16)
    return count == 0, count >= 16, f"{count:.0f} of 32"


@rule("50", "E5", "ours env-rigid pl-gm")
def turns_dearly(case):
    def cost(controller):
        """Of the seeds that have a success."""
        costs = case.evidence.figure("E5", controller, lambda g: mean_value(
            select(g, "air-mattress", "turn", -1.0, 1.0), "cotu", True))
        return median([cost.value for cost in costs.values() if not math.isnan(cost.value)])
    ratios = {other: cost(other) / cost("ours") for other in ("env-rigid", "pl-gm")}
    case.needs_success(*ratios.values())
    return (all(turned(case, other, 16) >= 1 and ratio >= 1.3 for other, ratio in ratios.items()),
            all(ratio < 1.0 for ratio in ratios.values()),
            ", ".join(f"{name_of(other)} {number(ratio)}" for other, ratio in ratios.items()) + " times that of Ours")


@rule("51", "E6", "ours")
def walks_on_foam(case):
    alive = case.evidence.figure("E6", "ours", lambda g: mean_value(select(g, "memory-foam"), "alive"))
    return median(alive) >= 15 / 16, median(alive) < FEW, percent(alive) + " alive"


@rule("66", "", "")
def faster_than_drft(case):
    ratio = case.evidence.contact["ratio"]
    return 10.0 <= ratio <= 40.0, ratio < 5.0, f"{ratio:.1f} times"


@rule("67", "", "")
def wider_than_drft(case):
    cone, drft, planar = (case.evidence.contact[name] for name in ("spread_cone", "spread_drft", "spread_planar"))
    return cone > max(drft, planar), cone < min(drft, planar), f"{cone:.2f}; DRFT {drft:.2f} and {planar:.2f}"
