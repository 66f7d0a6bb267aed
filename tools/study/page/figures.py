# SPDX-License-Identifier: BSD-3-Clause
"""The figures of E1, E3, E5, E6 and of the estimator."""
from dataclasses import dataclass

import numpy as np

from charts import (BLUE, DARK, GREEN, GREY, ORANGE, RED, Sheet, bars, caps, least_and_greatest, line, look,
                    name_axes)
from controllers import BEACH, COMMANDS, CONTROLLERS, name_of
from evidence import mean_value, median, run_values, select
from terms import rate_interval

FASTEST_MPS = 4.2  # end of the axes of speed
HARDER = {"vinyl": "vinyl tile", "athletic-track": "athletic track", "grass": "grass"}
TURNED = {"dry-sand": "dry sand", "wet-sand": "wet sand", "grass": "grass", "athletic-track": "track",
          "vinyl": "vinyl"}


@dataclass
class Figure:
    """`paper`: what the paper prints of it; `note`: what differs, and what is shown; either may be
    empty."""
    name: str  # of its PNG
    paper: str
    note: str
    sheet: Sheet


def ran(evidence, experiment):
    """The controllers that were run, each with its groups by seed."""
    return [(c, evidence.seeds(experiment, c.key)) for c in CONTROLLERS.values() if evidence.seeds(experiment, c.key)]


def label_of(controller, seeds):
    """Its name, and of how many trainings what is drawn is."""
    if controller.key == "published":
        return controller.name
    return f"{controller.name} ({len(seeds)} seed{'' if len(seeds) == 1 else 's'})"


def command_chart(ax, evidence, title, y_label, name, scale=1.0, experiment="E1", ground="beach", successes=True,
                  ends=None):
    """A figure over the command: the median over the seeds that have it, and, of the two figures
    `ends`, the least and greatest value of any successful run; of success, the 95 % interval."""
    for i, (controller, seeds) in enumerate(ran(evidence, experiment)):
        y, low, high = [], [], []
        for v in COMMANDS:
            of_seeds = [select(groups, ground, "", v, v) for groups in seeds.values()]
            values = np.array([mean_value(groups, name, successes).value for groups in of_seeds])
            y.append(scale * median(values[~np.isnan(values)]))
            if ends:
                runs = [np.concatenate([run_values(g, end, True).ravel() for g in of_seeds]) for end in ends]
                low.append(scale * least_and_greatest(runs[0])[0])
                high.append(scale * least_and_greatest(runs[1])[1])
            if name == "success":
                ends_of_rate = rate_interval(np.concatenate([run_values(g, name).ravel() for g in of_seeds]))
                low.append(scale * ends_of_rate[0])
                high.append(scale * ends_of_rate[1])
        line(ax, COMMANDS, y, label_of(controller, seeds), **look(controller))
        if low:
            caps(ax, np.array(COMMANDS) + 0.02 * (i % 5 - 2), low, high, controller.color)
    name_axes(ax, title, "commanded speed, m/s", y_label, True)
    ax.set_xlim(0.0, FASTEST_MPS)
    if name == "success":
        ax.set_ylim(0.0, 105.0)


def success_chart(ax, evidence):
    command_chart(ax, evidence, "Success (Fig. 2 D)", "success, %", "success", 100.0, successes=False)


def clearance_chart(ax, evidence):
    command_chart(ax, evidence, "Foot clearance, IQR (Fig. 2 E)", "mm", "iqr_m", 1e3,
                  ends=("iqr_least_m", "iqr_greatest_m"))


def fit_cost(speed, cost):
    """The curve a e^(bx) + cx + d with the least squares, as a function: b by a search in [-3, 3],
    the others by linear least squares. None with fewer than five points. (The paper prints "ae^{bx}
    + cx + b", with b twice.)"""
    good = np.isfinite(speed) & np.isfinite(cost)
    if good.sum() < 5:
        return None

    def terms(x, b):
        return np.column_stack([np.exp(b * x), x, np.ones_like(x)])

    def attempt(b):
        found = np.linalg.lstsq(terms(speed[good], b), cost[good], rcond=None)[0]
        return np.sum((terms(speed[good], b) @ found - cost[good]) ** 2), b, found
    # Without 0, where the exponential is no term of its own.
    _, b, found = min((attempt(b) for b in np.arange(-3.0, 3.005, 0.01) if abs(b) > 0.02), key=lambda fit: fit[0])
    return lambda x: terms(np.asarray(x), b) @ found


def cost_chart(ax, evidence, experiment, ground, title):
    """A dot for each successful run, and the fitted curve."""
    for controller, seeds in ran(evidence, experiment):
        groups = [g for of_seed in seeds.values() for g in select(of_seed, ground)]
        won = run_values(groups, "success") == 1.0
        speed, cost = run_values(groups, "speed_mps")[won], run_values(groups, "cot")[won]
        ax.plot(speed, cost, "o", color=controller.color, alpha=0.35, markersize=5, markeredgewidth=0)
        curve = fit_cost(speed, cost)
        x = np.linspace(speed.min(), speed.max(), 101) if curve else []
        line(ax, x, curve(x) if curve else [], label_of(controller, seeds), dots=False, **look(controller))
    name_axes(ax, title, "average speed, m/s", "cost of transport", True)
    ax.set_xlim(0.0, FASTEST_MPS)


def torque_chart(ax, controller, groups, leg):
    lists = select(groups, "beach", "torques")[0].lists
    for joint, color, dashes in (("HAA", GREY, (0, (2, 3))), ("HFE", BLUE, "-"), ("KFE", ORANGE, (0, (8, 3)))):
        torque = lists.get(f"{leg} {joint}", [])
        if len(torque):
            line(ax, 0.01 * np.arange(len(torque)), torque, joint, color, dashes, dots=False)
    if not ax.has_data():
        ax.text(0.5, 0.5, "no run near 1 m/s", transform=ax.transAxes, ha="center", fontsize=8)
    name_axes(ax, "", "time, s", "torque, N m" if controller.key == "ours" else "")
    ax.set_title(f"{controller.name}, {leg}", fontsize=9)
    ax.set_ylim(-65.0, 65.0)


def beach_figures(evidence):
    sheet = Sheet("Dry sand (Fig. 2 C, D, E)", 3, columns=3, height_in=3.8)
    cost_chart(sheet.axes[0], evidence, "E1", "beach", "Cost of transport (Fig. 2 C)")
    success_chart(sheet.axes[1], evidence)
    clearance_chart(sheet.axes[2], evidence)
    yield Figure(
        "fig2cde",
        "success overall: Ours 100 %, PL/Env-GM 72.5 %, Env-Rigid 50 %, PL/Env-Rigid 37.5 %, Env-Linear 17.5 %; cost "
        "and clearance are not printed",
        "C: a dot is a successful run, the curve a e^(bx) + cx + d (the paper prints b twice). E: the line is the mean "
        "over feet and successful runs, the caps are the least and the greatest foot of any run. Lines are medians "
        "over the seeds that have a success. D: the caps are the 95 % interval of the runs of all seeds; runs that "
        "fail before the start line do not count.", sheet)
    there = [key for key in BEACH if evidence.seeds("E1", key)]
    sheet = Sheet("Torques of the right legs at about 1 m/s on dry sand (Fig. 2 F)", 2 * len(there), len(there), 2.5)
    for ax, (leg, key) in zip(sheet.axes, [(leg, key) for leg in ("RF", "RH") for key in there]):
        torque_chart(ax, CONTROLLERS[key], next(iter(evidence.seeds("E1", key).values())), leg)
    yield Figure(
        "fig2f",
        "the run nearest to 1.0 m/s of each controller; \"Ours used lower peak torques than the other controllers\"; "
        "the values are not printed",
        "Extension is positive for HFE and KFE. One second at 100 Hz, first seed.", sheet)


def summary_figure(evidence):
    sheet = Sheet("Simulated dry sand: controllers trained on different grounds", 4)
    success_chart(sheet.axes[0], evidence)
    command_chart(sheet.axes[1], evidence, "Average speed over 5 m", "m/s", "speed_mps",
                  ends=("speed_mps", "speed_mps"))
    cost_chart(sheet.axes[2], evidence, "E1", "beach", "Cost of transport (Fig. 2 C)")
    clearance_chart(sheet.axes[3], evidence)
    return Figure("summary", "", "", sheet)


def turn_bars(ax, evidence, experiment, grounds, title, y_label, name, scale=1.0, successes=False, with_caps=True):
    """A figure of turns at 1 rad/s both ways, a bar for each controller, with the least and
    greatest run."""
    series = []
    for controller, seeds in ran(evidence, experiment):
        heights, ends = [], []
        for ground in grounds:
            of_seeds = [[g for g in select(groups, ground, "turn") if abs(g.command) == 1.0]
                        for groups in seeds.values()]
            means = np.array([mean_value(groups, name, successes).value for groups in of_seeds])
            heights.append(scale * median(means[~np.isnan(means)]))  # of the seeds that have it
            ends.append(least_and_greatest(
                scale * np.concatenate([run_values(g, name, successes).ravel() for g in of_seeds])))
        series.append((label_of(controller, seeds), controller.color, heights, list(zip(*ends)) if with_caps else None))
    if series:
        bars(ax, list(grounds.values()), series)
    name_axes(ax, title, "", y_label, True)


def ground_figures(evidence):
    sheet = Sheet("Vinyl tile, athletic track and grass (Fig. 3 D, E)", 6, columns=3)
    for i, (ground, name) in enumerate(HARDER.items()):
        cost_chart(sheet.axes[i], evidence, "E3", ground, f"Cost, {name}")
        command_chart(sheet.axes[3 + i], evidence, f"Speed, {name}", "average speed, m/s", "speed_mps", 1.0, "E3",
                      ground, ends=("speed_mps", "speed_mps"))
    yield Figure(
        "fig3de",
        "top speeds of Ours 3.13 m/s on grass, 3.62 on the track, 3.76 on vinyl; Env-Rigid 6.1 % slower on the track "
        "and 10.1 % on grass; costs are not printed",
        "5 m to speed up, then 5 m of track, as in the paper. Ours was trained on hard ground (as vinyl) and on soils "
        "of the kind of our grass, never on springs (as the track).", sheet)
    sheet = Sheet("Yaw rate at a command of 1 rad/s", 1, columns=1)
    turn_bars(sheet.axes[0], evidence, "E3", TURNED, "", "rad/s", "yaw_rate_radps")
    yield Figure("turns",
                 "0.92 rad/s on dry sand, \"in all terrains\" around 0.94 rad/s; the command is not printed",
                 "10 s on the spot, as many runs each way; caps: least and greatest run.", sheet)


def mattress_figures(evidence):
    sheet = Sheet("Air mattress at a command of 1 rad/s (Fig. 3 H)", 3, columns=3)
    ground = {"air-mattress": "air mattress"}
    turn_bars(sheet.axes[0], evidence, "E5", ground, "Success", "%", "success", 100.0, with_caps=False)
    sheet.axes[0].set_ylim(0.0, 105.0)
    turn_bars(sheet.axes[1], evidence, "E5", ground, "Cost of turning", "", "cotu", successes=True)
    turn_bars(sheet.axes[2], evidence, "E5", ground, "Yaw rate", "rad/s", "yaw_rate_radps")
    yield Figure(
        "fig3h",
        "Ours turns at 0.71 rad/s, and at 1.54 rad/s for 2 rad/s; PL/Env-Rigid never makes half a turn; rates and "
        "costs of turning are not printed",
        "As many runs each way; the paper has five. Success: more than half a turn in 10 s without a contact of base "
        "or thigh.", sheet)


def foam_figures(evidence):
    sheet = Sheet("From hard ground onto memory foam at 0.5 m/s (fig. S8)", 2)
    for controller, seeds in ran(evidence, "E6"):
        lists = next(iter(seeds.values()))[0].lists
        for ax, y in zip(sheet.axes, (1e3 * lists["depth_m"], lists["speed_mps"])):
            line(ax, lists["x_m"], y, label_of(controller, seeds), dots=False, **look(controller))
    name_axes(sheet.axes[0], "Deepest foot", "distance, m", "mm")
    name_axes(sheet.axes[1], "Speed", "distance, m", "m/s")
    yield Figure("s8", "\"could stably traverse over it with a command at 0.5 m/s\"; no numbers",
                 "Run 0 of the first seed. The foam begins at 2 m. It is an overdamped spring; no foam was measured.",
                 sheet)


def estimator_figures(evidence):
    sheet = Sheet(f"The estimate of {name_of('ours')} (section S4)", 3, columns=3)
    parts = (("velocity_rmse_mps", "Velocity", "m/s", 1.0), ("body_height_rmse_m", "Body height", "mm", 1e3),
             ("foot_height_rmse_m", "Foot heights", "mm", 1e3))
    looks = (((0.80, 0.58, 0.10), "-"), (DARK, (0, (9, 4))), (RED, (0, (3, 3))), (GREEN, (0, (9, 3, 2, 3))))
    for ax, (name, title, unit, scale) in zip(sheet.axes, parts):
        for (ground, label), (color, dashes) in zip({"beach": "dry sand", **HARDER}.items(), looks):
            errors = [evidence.figure("E1" if ground == "beach" else "E3", "ours", lambda g: mean_value(
                select(g, ground, "", v, v), name)) for v in COMMANDS]
            if errors[0]:
                line(ax, COMMANDS, [scale * median(error) for error in errors], label, color, dashes)
        name_axes(ax, title, "commanded speed, m/s", unit, True)
    yield Figure("s4", "not printed",
                 "Root mean square error over the steady half of each run, mean over the runs without a fall.", sheet)
