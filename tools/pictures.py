#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tools/pictures.py DIR: draws the CSV files of a folder, each as PNG files next to it.

  run.csv       run.png: the whole run, and one second of it; strip.png: the robot from its side,
                if there is ground truth
  curve.csv     curve.png: the most telling columns of a training's curve
  straight.csv  straight_speed.png, straight_cost.png
  grid.csv      grid.png
  commands.csv  commands.png: with the policies' envelopes, if evaluation.json has them

Needs Debian's python3-matplotlib. Exit code 2: one line says what is missing."""
import csv
import json
import sys
from pathlib import Path

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
except ModuleNotFoundError as error:
    if __name__ != "__main__":
        raise
    print(f"pictures.py: drew nothing: found no Python module {error.name}, expected the Debian package python3-matplotlib",
          file=sys.stderr)
    sys.exit(2)

DOTS_PER_IN = 100
INK, FAINT, BLUE, ORANGE, TEAL = "#21262e", "#6b737f", "#1f6bbf", "#e6730d", "#0d9980"
STYLE = {"font.size": 8.5, "axes.edgecolor": "#9aa1aa", "axes.titlesize": 9, "axes.titleweight": "bold",
         "axes.titlelocation": "left", "axes.grid": True, "axes.axisbelow": True, "grid.color": "#e3e6ea",
         "text.color": INK, "axes.labelcolor": FAINT, "xtick.major.size": 0, "ytick.major.size": 0, "lines.linewidth": 1.1,
         "savefig.dpi": DOTS_PER_IN}
# Where a legend is: above its chart.
ABOVE = {"loc": "lower right", "bbox_to_anchor": (1.0, 0.98), "ncol": 5, "frameon": False}
# Legs of a pair often move alike: left ones are wide and light, right ones narrow and dark on top.
LEGS = ("#99c9f7", "#0d4d9e", "#fac27a", "#b84d05")


class Refused(OSError):
    """What is wrong with a file, in one line."""


class Table(dict):
    """The columns of a CSV file by name, as numbers (an empty cell is nan) or texts."""

    TEXTS = {"mode", "policy", "ground", "scenario"}

    def __init__(self, path):
        self.path = path
        with open(path, newline="", encoding="utf-8", errors="replace") as file:
            rows = csv.reader(file)
            names = next(rows, [])
            columns = [[] for _ in names]
            for row in rows:
                if len(row) != len(names):
                    raise Refused(f"{path}:{rows.line_num}: found {len(row)} cells, expected {len(names)}")
                for name, column, cell in zip(names, columns, row):
                    try:
                        column.append(cell if name in self.TEXTS else float(cell or "nan"))
                    except ValueError:
                        raise Refused(f"{path}:{rows.line_num}: {name}: found '{cell}', expected a number") from None
        found = len(columns[0]) if names else 0
        if found < 2:
            raise Refused(f"{path}: found {found} rows, expected a row of names and at least 2 more")
        super().__init__((name, np.array(column)) for name, column in zip(names, columns))

    def __missing__(self, name):
        raise Refused(f"{self.path}: found no column {name}, which the picture needs")


def read_json(path):
    """What the file has; nothing without one."""
    try:
        return json.loads(path.read_bytes()) if path.is_file() else {}
    except ValueError:
        raise Refused(f"{path}: found something else, expected JSON") from None


def charts(rows, columns, size_in, title="", **more):
    """A figure of charts, and these by row and column."""
    figure, axes = plt.subplots(rows, columns, squeeze=False, figsize=size_in, layout="constrained", **more)
    figure.suptitle(title, x=0.01, ha="left", fontsize=11, fontweight="bold")
    return figure, axes


def save(figure, path):
    figure.savefig(path)
    plt.close(figure)
    return path


# Runs.

def walk_of(run):
    """First and last row in Walk; of all rows if there is none."""
    walking = np.flatnonzero(run["mode"] == "walk")
    return (walking[0], walking[-1]) if len(walking) else (0, len(run["t_s"]) - 1)


def second_of(run):
    """A second worth a closer look, as title, first and last row: the last one under the largest
    command that was held for one; the last one of Walk if it did not end in Stand."""
    t, (first, last) = run["t_s"], walk_of(run)
    command = np.array([run[f"command_{name}"] for name in ("vx_mps", "vy_mps", "wz_radps")])
    size, held, end, largest = np.linalg.norm(command, axis=0), first, last, -1.0
    title, ended_well = f"last second of {run['mode'][last]}", (run["mode"][last + 1:last + 2] == "stand").all()
    for i in range(first, last + 1 if ended_well else first):
        if (command[:, i] != command[:, held]).any():
            held = i
        if t[i] - t[held] >= 1.0 and size[i] >= largest:
            end, largest = i, size[i]
            title = "one second of steady gait, command {:.3g}, {:.3g} m/s, {:.3g} rad/s".format(*command[:, i])
    return title, np.searchsorted(t, t[end] - 1.0), end


def legs_of(run):
    return [name.removesuffix("_penetration_m") for name in run if name.endswith("_penetration_m")]


def panels_of(run):
    """Title, unit, least range and lines (name, column, colour) of each chart of run.png."""
    torques = [name for name in run if name.endswith("_torque_nm") and "_peak_" not in name]
    legs = legs_of(run)
    yield "Speed, heading frame", "m/s", 0.5, [
        ("vx", "vx_mps", BLUE), ("vy", "vy_mps", TEAL), ("vx commanded", "command_vx_mps", INK),
        ("vy commanded", "command_vy_mps", FAINT)]
    yield "Yaw rate", "rad/s", 0.5, [("yaw rate", "yaw_rate_radps", BLUE), ("commanded", "command_wz_radps", INK)]
    for k, joint in enumerate(torques[:3]):
        kind = joint.removesuffix("_torque_nm").removeprefix(legs[0]).strip("_")
        yield f"Torque, {kind}", "N m", 10.0, list(zip(legs, torques[k::3], LEGS))
    yield "Sinkage of the feet", "mm", 10.0, [(leg, f"{leg}_penetration_m", color) for leg, color in zip(legs, LEGS)]
    for title, unit, least, column in (("Forward speed, body frame", "m/s", 0.5, "velocity_x_mps"),
                                       ("Body height", "m", 0.1, "body_height_m")):
        yield f"{title}: estimate against truth", unit, least, [
            ("truth", f"truth_{column}", INK), ("estimate", f"estimate_{column}", ORANGE)]


def run_picture(run, title, path):
    t, modes, panels = run["t_s"], run["mode"], list(panels_of(run))
    detail, first, last = second_of(run)
    figure, axes = charts(len(panels), 2, (18, 15), title, sharex="col", width_ratios=(0.68, 0.32))
    changes = [0, *(np.flatnonzero(modes[1:] != modes[:-1]) + 1), len(t) - 1]
    for row, (name, unit, least, lines) in zip(axes, panels):
        for ax, rows in zip(row, (slice(None), slice(first, last + 1))):
            for label, column, color in lines:
                values = np.maximum(1e3 * run[column], 0.0) if unit == "mm" else run[column]
                look = {"linestyle": "--", "drawstyle": "steps-post"} if column.startswith("command_") else {}
                width = 3.0 if color in LEGS[::2] else 1.1
                ax.plot(t[rows], values[rows], label=label, color=color, linewidth=width, **look)
            middle, half = np.mean(ax.get_ylim()), 0.5 * max(np.ptp(ax.get_ylim()), least)
            ax.set_ylim(middle - half, middle + half)
            ax.margins(x=0.0)
        row[0].set(title=name, ylabel=unit)
        row[0].legend(**ABOVE)
        for begin, end in zip(changes, changes[1:]):
            if modes[begin] != "walk":
                row[0].axvspan(t[begin], t[end], color="#fce5e3" if modes[begin] == "fault" else "#f0f2f5", zorder=0)
    for begin, end in zip(changes, changes[1:]):
        if t[end] - t[begin] > 0.05 * (t[-1] - t[0]):  # room for a word
            axes[0, 0].annotate(f" {modes[begin]}", (t[begin], 1.0), xycoords=("data", "axes fraction"), va="top", color=FAINT)
    axes[0, 1].set_title(detail)
    axes[-1, 0].set_xlabel("time, s (grey: not in Walk; red: Fault)")
    axes[-1, 1].set_xlabel("time, s")
    return save(figure, path)


# The robot from its right side. What lies to its left is drawn further to the front and up by these
# shares of its distance: the left legs of a robot that bounds would hide behind the right ones.
AHEAD_PER_LEFT, UP_PER_LEFT = 0.24, 0.12
VIEW_M, BELOW_GROUND_M, FOOT_M = (1.336, 0.985), 0.23, 0.03
PIXELS_PER_M = 262


def side_view(ax, run, row, time_s, walked_m):
    """One row of run.csv, the base in the middle."""
    legs = legs_of(run)
    w, x, y, z = (run[f"orientation_{name}"][row] for name in "wxyz")
    heading = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))

    def place(leg, end, rows=slice(None)):
        """Where points of a leg are: metres ahead of the base, to its left, third column."""
        x, y, third = (run[f"{leg}_{end}_{name}_m"][rows] for name in ("x", "y", "depth" if end == "stance" else "z"))
        x, y = x - run["base_x_m"][row], y - run["base_y_m"][row]
        return np.cos(heading) * x + np.sin(heading) * y, np.cos(heading) * y - np.sin(heading) * x, third

    def seen(leg, end):
        ahead, left, up = place(leg, end, row)
        return ahead + AHEAD_PER_LEFT * left, up + UP_PER_LEFT * left

    def draw_ground(side, left, fill, edge):
        """The surface as known where feet of this side were, with the footprints so far. Their
        shape is drawn, not simulated."""
        ahead = np.linspace(-0.6, 0.6, 400) * VIEW_M[0]
        feet, prints = ([np.concatenate(columns) for columns in zip(*(place(leg, *which) for leg in side))]
                        for which in (("foot",), ("stance", slice(row + 1))))
        near = np.abs(feet[0]) < VIEW_M[0]
        levels = np.concatenate([run[f"{leg}_ground_height_m"] for leg in side])[near]
        places, index = np.unique(np.round(feet[0][near] / 0.05), return_inverse=True)
        level = np.interp(ahead, 0.05 * places, np.bincount(index, levels) / np.bincount(index))
        here = (prints[2] > 0) & (np.abs(prints[0]) < VIEW_M[0]) & (np.abs(prints[1]) < 0.45)
        at, _, depth = np.unique([column[here] for column in prints], axis=1)
        holes = depth - np.maximum(np.abs(ahead[:, None] - at) - FOOT_M, 0.0) * 3 ** 0.5
        u, z = ahead + AHEAD_PER_LEFT * left, level - np.max(holes, axis=1, initial=0.0) + UP_PER_LEFT * left
        ax.fill_between(u, z, z.min() - 1.0, color=fill, zorder=1)
        ax.plot(u, z, color=edge, linewidth=1, zorder=1)
        return level[len(level) // 2]
    sand = max(run[f"{leg}_stance_depth_m"].max() for leg in legs) > 0.01
    points = PIXELS_PER_M * 72 / DOTS_PER_IN
    earth, edge = (("#e6cc99", "#ccad75"), "#997840") if sand else (("#ccced4", "#b8babf"), "#737880")
    for far, color in ((True, "#7899bd"), (False, "#1a3354")):
        side = legs[not far::2]
        level = draw_ground(side, np.mean([place(leg, "hip", row)[1] for leg in side]), earth[far], edge)
        for leg in side:
            hip, knee, foot = (seen(leg, end) for end in ("hip", "knee", "foot"))
            for ends, width in (((knee, foot), 0.026), ((hip, knee), 0.058)):
                ax.plot(*zip(*ends), color=color, linewidth=points * width, solid_capstyle="round", zorder=2 if far else 4)
    front, rear = (np.mean([seen(leg, "hip") for leg in pair], axis=0) for pair in (legs[:2], legs[2:]))
    # The dark end tells front from rear.
    for begin, color in ((rear, "#ed8521"), (0.9 * front + 0.1 * rear, "#994d0d")):
        ax.plot(*zip(begin, front), color=color, linewidth=points * 0.13, zorder=3, solid_capstyle="projecting")
    bottom = level - BELOW_GROUND_M
    ax.set(xlim=(-0.5 * VIEW_M[0], 0.5 * VIEW_M[0]), ylim=(bottom, bottom + VIEW_M[1]), xticks=[], yticks=[],
           facecolor="#edf4fa")
    for mark in np.arange(np.ceil(2 * walked_m - VIEW_M[0]), 2 * walked_m + VIEW_M[0]) / 2:
        if abs(mark - walked_m) < 0.44 * VIEW_M[0]:
            ax.text(mark - walked_m, bottom + 0.02, f"{mark + 0.0:g} m", color=FAINT, ha="center")
    ax.text(0.03, 0.91, f"{round(time_s, 2) + 0.0:.2f} s", transform=ax.transAxes, fontsize=11, fontweight="bold")
    ax.text(0.97, 0.91, f"{run['vx_mps'][row]:.2f} m/s", transform=ax.transAxes, fontsize=11, ha="right")


def side_views(run, rows, columns, title, path, zero_s=0.0):
    """Draws the robot in these rows of run.csv; times from `zero_s`, distances from the first row."""
    width, height = (PIXELS_PER_M * size + 8 for size in VIEW_M)
    size = np.array([columns * width + 8, -(-len(rows) // columns) * height + 46])
    figure = plt.figure(figsize=size / DOTS_PER_IN)
    figure.text(10 / size[0], 1 - 30 / size[1], title, fontsize=13, fontweight="bold")
    figure.text(1 - 10 / size[0], 1 - 30 / size[1], "left legs light; below: metres walked", ha="right", color=FAINT)
    walked = np.concatenate([[0.0], np.cumsum(np.nan_to_num(run["vx_mps"][1:]) * np.diff(run["t_s"]))])
    for i, row in enumerate(rows):
        corner = 8 + i % columns * width, size[1] - 38 - (i // columns + 1) * height
        ax = figure.add_axes([*corner / size, *np.array([width - 8, height - 8]) / size])
        side_view(ax, run, row, run["t_s"][row] - zero_s, walked[row] - walked[rows[0]])
    return save(figure, path)


def draw_run(run, folder):
    summary = read_json(folder / "summary.json")
    title = " on ".join(["Sandrunner", *filter(None, [summary.get("terrain")])])
    if summary.get("policy"):
        title += f", policy {summary['policy']}"
    yield run_picture(run, title, folder / "run.png")
    if np.isfinite(run["truth_body_height_m"]).any():
        first, last = walk_of(run)
        yield side_views(run, np.linspace(first, last, 10).astype(int), 5, title, folder / "strip.png")


# Trainings.

CURVES = (("Battery: runs without a fall", "share", {"all": "battery_alive", "fastest forward": "battery_alive_5"}),
          ("Battery: tracking error", "of the command", {"error": "battery_error"}),
          ("Battery: cost of transport", "forward", {"mean": "battery_cost_of_transport"}),
          ("Battery: a joint too fast", "share of time", {"too fast": "battery_too_fast"}),
          ("Late penalties and settling", "share", {"late penalties": "late_penalties", "settled": "settled"}),
          ("Reward", "a step", {"reward": "reward"}),
          ("Velocity tracking", "kernel, 0 to 1", {"rigid": "kernel_rigid", "soil": "kernel_soil"}),
          ("Falls", "per robot and 4 s", {"rigid": "falls_rigid_per_4s", "soil": "falls_soil_per_4s"}),
          ("Gait: strides", "Hz", {"stride": "stride_hz"}),
          ("Gait: feet together in the air", "correlation", {"diagonal": "diagonal", "side by side": "abreast"}),
          ("Curricula", "m/s; 0 to 1", {"commanded speed": "command_speed_mps", "softness of the ground": "ground_open"}),
          ("Estimator", "rms error", {"vx, m/s": "estimate_vx_rms_mps", "body height, m": "estimate_height_rms_m"}))


def draw_curve(curve, folder):
    figure, axes = charts(len(CURVES) // 2, 2, (18, 13), sharex=True)
    for ax, (title, unit, lines) in zip(axes.flat, CURVES):
        for (label, column), color in zip(lines.items(), (BLUE, ORANGE)):
            ax.plot(curve["transitions"] / 1e6, curve[column], label=label, color=color)
        ax.set(title=title, ylabel=unit)
        ax.legend(**ABOVE)
    for ax in axes[-1]:
        ax.set_xlabel("million transitions")
    yield save(figure, folder / "curve.png")


# Evaluations.

def names(column):
    """The texts of a column, each once, in their order."""
    return list(dict.fromkeys(column))


def draw_straight(part, folder):
    grounds = names(part["ground"])
    speeds = {"whole track": "track_speed_mps", "last gait cycle": "track_end_speed_mps"}
    for what, x, lines in (("speed", "command_vx_mps", speeds), ("cost", "vx_mps", {"": "cot"})):
        figure, axes = charts(len(grounds), 1, (11, 2.2 * len(grounds) + 0.8), sharex=True, sharey=True)
        for ax, ground in zip(axes[:, 0], grounds):
            for policy, color in zip(names(part["policy"]), (BLUE, ORANGE)):
                rows = np.flatnonzero((part["ground"] == ground) & (part["policy"] == policy))
                rows = rows[np.argsort(part[x][rows])]
                for (label, column), style in zip(lines.items(), ("o-", "o:")):
                    ax.plot(part[x][rows], part[column][rows], style, color=color, markersize=4,
                            label=", ".join(filter(None, [policy, label])))
            if not np.isfinite(part[[*lines.values()][0]][part["ground"] == ground]).any():
                ax.text(0.5, 0.5, "no run finished", transform=ax.transAxes, ha="center", color=FAINT)
            if what == "speed":
                ax.axline((0.0, 0.0), slope=1.0, linestyle="--", color=FAINT, label="command")
            ax.set(title=ground, ylabel="speed, m/s" if what == "speed" else "cost of transport")
        axes[0, 0].legend(**ABOVE)
        axes[0, 0].set(ylim=(0.0, None), xlim=(0.0, 4.5))
        axes[-1, 0].set_xlabel("commanded speed, m/s" if what == "speed" else "steady speed, m/s")
        yield save(figure, folder / f"straight_{what}.png")


def draw_map(ax, x, y, values, digits, **colors):
    """A coloured cell with its number for each x and y; blank: not a number."""
    across, up = np.unique(x), np.unique(y)
    cells = np.full((len(up), len(across)), np.nan)
    cells[np.searchsorted(up, y), np.searchsorted(across, x)] = values
    ax.pcolormesh(across, up, np.ma.masked_invalid(cells), alpha=0.6, **colors)
    for at, other, value in zip(x, y, values):
        ax.text(at, other, f"{value:.{digits}f}" if np.isfinite(value) else "", ha="center", va="center")
    ax.set(xticks=across, yticks=up)
    ax.grid(False)


def draw_grid(part, folder):
    policies = names(part["policy"])
    maps = (("survival", "survival, %", 100, 0), ("velocity_error_mps", "velocity error, m/s", 1, 2),
            ("yaw_error_radps", "yaw rate error, rad/s", 1, 2), ("clearance_iqr_m", "foot clearance (IQR), mm", 1000, 0))
    figure, axes = charts(len(maps), len(policies), (6 * len(policies), 14),
                          f"Stiffness grid, {part['runs'][0]:.0f} robots in each cell")
    for row, (column, title, scale, digits) in zip(axes, maps):
        values = scale * part[column]
        for ax, policy in zip(row, policies):
            rows = part["policy"] == policy
            draw_map(ax, part["sigma_flat_npm3"][rows] / 1e6, part["sigma_cone_npm3"][rows] / 1e6, values[rows], digits,
                     cmap="YlGnBu_r" if column == "survival" else "YlGnBu", vmin=np.fmin.reduce(values),
                     vmax=np.fmax.reduce(values))
            ax.set(title=f"{policy}: {title}", xlabel="sigma_flat, MN/m³", ylabel="sigma_cone, MN/m³")
    yield save(figure, folder / "grid.png")


def draw_commands(part, folder):
    policies, planes = names(part["policy"]), names(part["scenario"])
    envelopes = {p["name"]: p["envelope"] for p in read_json(folder / "evaluation.json").get("policies", ())
                 if "envelope" in p}
    figure, axes = charts(len(planes), len(policies), (7 * len(policies), 8),
                          f"% of {part['runs'][0]:.0f} robots on their feet after 6 s on the worst ground\n"
                          "Outline: the policy's envelope")
    for row, plane in zip(axes, planes):
        sideways = plane == "vx by vy"
        for ax, policy in zip(row, policies):
            worst = {}
            for at in np.flatnonzero((part["policy"] == policy) & (part["scenario"] == plane)):
                cell = part["command_vx_mps"][at], part["command_vy_mps" if sideways else "command_wz_radps"][at]
                worst[cell] = min(worst.get(cell, 1.0), part["survival"][at])
            draw_map(ax, *np.array(list(worst)).T, 100 * np.array(list(worst.values())), 0, cmap="RdYlGn", vmin=0, vmax=100)
            if policy in envelopes:
                e, angle = envelopes[policy], np.linspace(0, 2 * np.pi, 97)
                c, s = (np.cos(angle), np.sin(angle)) if sideways else np.array([[1, -1, -1, 1, 1], [1, 1, -1, -1, 1]])
                ax.plot(c * np.where(c < 0, e["backward_mps"], e["forward_mps"]),
                        s * e["lateral_mps" if sideways else "yaw_radps"], color=INK, linewidth=2)
            ax.set(title=f"{policy}: {plane}", xlabel="vx, m/s", ylabel="vy, m/s" if sideways else "yaw rate, rad/s")
    yield save(figure, folder / "commands.png")


PARTS = {"run.csv": draw_run, "curve.csv": draw_curve, "straight.csv": draw_straight, "grid.csv": draw_grid,
         "commands.csv": draw_commands}


def main():
    if len(sys.argv) != 2 or sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        return 0 if len(sys.argv) == 2 else 2
    folder = Path(sys.argv[1])
    plt.rcParams.update(STYLE)
    try:
        files = [name for name in PARTS if (folder / name).is_file()]
        if not files:
            raise Refused(f"{folder}: found none of its files, expected one of {', '.join(PARTS)}")
        for name in files:
            for picture in PARTS[name](Table(folder / name), folder):
                print(f"wrote {picture}")
    except OSError as error:
        print(f"pictures.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
