# SPDX-License-Identifier: BSD-3-Clause
"""The figures of E2's run, E4, E7, E8, of the ball on beads and of the trainings."""
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize

import hidden_state
from charts import (BLUE, DARK, GREEN, GREY, INK, ORANGE, RED, Sheet, bars, caps, least_and_greatest, line, look,
                    name_axes)
from controllers import CONTROLLERS, GRID, ORACLES
from evidence import grid_list, grid_medians, mean, median, oracle_ablation, oracle_value, select
from figures import Figure, label_of
from rules_oracles import JOINTS
from terms import values_of

# A cell with no more success than this is black: the paper's criterion.
LEAST_SUCCESS = 0.10
QUANTITIES = (("reward", "mean reward of a step", 1.0, 2), ("clearance_m", "mean foot clearance, mm", 1e3, 0))
# Light yellow over green to dark blue, ends after ColorBrewer's YlGnBu.
SHADES = LinearSegmentedColormap.from_list(
    "grid", [(1.00, 1.00, 0.85), (0.78, 0.91, 0.71), (0.25, 0.71, 0.77), (0.13, 0.37, 0.66)])
# Parameters of the ground that vary on soil: their places among all, the labels of their bars.
VARYING = {1: "flat", 2: "cone", 3: "friction", 4: "inertia", 6: "recr.", 7: "cone ang.", 8: "str. k", 9: "str. b"}


def name_with_seeds(evidence, experiment, key):
    return label_of(CONTROLLERS[key], evidence.seeds(experiment, key))


def recovery_figure(run):
    """`run`: the part of results.json about the run whose left front foot meets loose sand."""
    sheet = Sheet("Around the loose stance", 3, columns=3)
    speed, tilt, feet = sheet.axes
    line(speed, run["t_s"], run["vx_mps"], None, BLUE, dots=False)
    line(tilt, run["t_s"], run["roll_deg"], "roll", DARK, (0, (8, 4)), dots=False)
    line(tilt, run["t_s"], run["pitch_deg"], "pitch", RED, dots=False)
    line(feet, run["t_s"], run["left_foot_mm"], "left front foot", ORANGE, dots=False)
    line(feet, run["t_s"], run["right_foot_mm"], "right front foot", (0.00, 0.55, 0.40), (0, (8, 4)), dots=False)
    name_axes(speed, "Forward speed", "time, s", "m/s")
    name_axes(tilt, "Tilt of the base", "time, s", "degrees")
    name_axes(feet, "Heights of the front feet", "time, s", "mm")
    return Figure("fig2b", "", "Time from the touchdown of the left front foot on the strip.", sheet)


def hidden_state_figures(evidence):
    sheet = Sheet("Hidden states of Ours (Fig. 3 F)", 2, height_in=5.2)
    seeds = evidence.seeds("E4", "ours")
    group = next(iter(seeds.values()))[0]
    if "hidden" in group.packed:
        x, y = hidden_state.embedded(group).T
        ground = group.lists["ground_of_run"][group.lists["run"].astype(int)]
        grounds = (("vinyl tile", DARK), ("athletic track", RED), ("grass", GREEN), ("dry sand", (0.85, 0.62, 0.10)))
        phase = np.floor(8 * group.lists["phase"]) % 8
        # A colour on a circle: a phase has no beginning.
        hues = [tuple(0.5 + 0.42 * np.cos(2 * np.pi * (p / 8 - third / 3)) for third in range(3)) for p in range(8)]
        for k, (label, color) in enumerate(grounds):
            sheet.axes[0].plot(x[ground == k], y[ground == k], "o", label=label, color=color, markersize=4)
        for p in range(8):
            sheet.axes[1].plot(x[phase == p], y[phase == p], "o", label=f"phase {p}/8", color=hues[p], markersize=4)
    name_axes(sheet.axes[0], "By ground")
    name_axes(sheet.axes[1], "By phase of the gait")
    yield Figure(
        "fig3f",
        "\"embedded hidden states distributed distinctly for different terrains\"; no numbers",
        "t-SNE of up to 2,000 states of the first seed at 1 m/s, from 8 runs of 10 s on each ground, perplexity 30, "
        "started from the principal components. Left: by ground. Right: by the phase of the left front foot. The "
        "numbers below the picture can fail; it cannot.", sheet)


def visible_cells(evidence, key, name, scale):
    """A value for each cell, nan where the cell is black."""
    success = grid_medians(evidence, key, "success")
    return np.where(success > LEAST_SUCCESS, scale * grid_medians(evidence, key, name), np.nan)


def ran_on_grid(evidence):
    return [key for key in GRID if evidence.seeds("E7", key)]


def stiffnesses(evidence, key, name):
    """The grid's values of a stiffness, of each cell, MN/m^3."""
    return 1e-6 * grid_list(next(iter(evidence.seeds("E7", key).values())), name)


def draw_map(ax, values, flat, cone, scale, digits, title):
    """A table of numbers as coloured cells."""
    shape = len(np.unique(flat)), len(np.unique(cone))
    cells = np.ma.masked_invalid(values.reshape(shape).T)
    ax.pcolormesh(cells, cmap=scale.cmap, norm=scale.norm)
    ax.set_facecolor((0.2, 0.2, 0.2))
    for (row, column), value in np.ndenumerate(cells.filled(np.nan)):
        if not np.isnan(value):
            red, green, blue, _ = scale.to_rgba(value)
            dark = 0.3 * red + 0.6 * green + 0.1 * blue < 0.55
            ax.text(column + 0.5, row + 0.5, f"{value:.{digits}f}", ha="center", va="center", fontsize=7.5,
                    color="white" if dark else INK)
    ax.set_xticks(np.arange(shape[0]) + 0.5, [f"{v:.1f}" for v in np.unique(flat)])
    ax.set_yticks(np.arange(shape[1]) + 0.5, [f"{v:.2f}" for v in np.unique(cone)])
    ax.grid(False)
    name_axes(ax, title, "sigma_flat, MN/m³", "sigma_cone, MN/m³")


def grid_maps(evidence):
    """Reward and clearance, all controllers on one scale."""
    there = ran_on_grid(evidence)
    sheet = Sheet("Reward and foot clearance over the grid of stiffnesses (Fig. 4 A to D)", 2 * len(there), 2, 3.5)
    for column, (name, title, scale, digits) in enumerate(QUANTITIES):
        maps = [visible_cells(evidence, key, name, scale) for key in there]
        # Dark is little reward, or a high foot.
        colors = SHADES.reversed() if name == "reward" else SHADES
        low, high = least_and_greatest(np.concatenate(maps))
        shared = ScalarMappable(Normalize(low, high), colors)
        sheet.figure.colorbar(shared, ax=sheet.axes[column::2], location="bottom", label=title, fraction=0.02,
                              aspect=50)
        for row, (key, values) in enumerate(zip(there, maps)):
            draw_map(sheet.axes[2 * row + column], values, stiffnesses(evidence, key, "sigma_flat_npm3"),
                     stiffnesses(evidence, key, "sigma_cone_npm3"), shared, digits, f"{name_with_seeds(evidence, 'E7', key)}: {title}")
    return Figure(
        "fig4ad",
        "\"tested 360 times with a randomly sampled velocity command for 4 s\"; rewards, clearances and table S1 are "
        "not printed",
        "The reward is that of our training with all penalties at their final weight, the mean of a step; a fall costs "
        "its penalty and all later reward. The paper's reward is eq. S17, which its main text does not print. "
        "Clearance is the mean height of the feet above the mean of the deepest points of their stances, of the robots "
        "that do not fall. Black cells: at most 10 % succeed, as in the paper. With several seeds a cell is their "
        "median.", sheet)


def grid_lines(evidence):
    """A quantity over one stiffness: the mean over the other one."""
    sheet = Sheet("Over each stiffness", 4)
    charts = [(quantity, stiffness) for quantity in QUANTITIES for stiffness in ("sigma_flat", "sigma_cone")]
    for ax, ((name, title, scale, _), stiffness) in zip(sheet.axes, charts):
        for key in ran_on_grid(evidence):
            at, values = stiffnesses(evidence, key, stiffness + "_npm3"), visible_cells(evidence, key, name, scale)
            line(ax, np.unique(at), [mean(values[at == x]) for x in np.unique(at)],
                 name_with_seeds(evidence, "E7", key), **look(CONTROLLERS[key]))
        name_axes(ax, f"Over {stiffness}", f"{stiffness}, MN/m³", title)
    return Figure("fig4_lines", "not printed",
                  "Mean over the other stiffness, without black cells; medians over the seeds.", sheet)


def seed_bars(label, color, figures):
    """Bars with the medians over the seeds; with several seeds the least and the greatest."""
    ends = [least_and_greatest(values_of(figure)) for figure in figures]
    several = any(len(figure) > 1 for figure in figures)
    return label, color, [median(figure) for figure in figures], list(zip(*ends)) if several else None


def stiffness_chart(ax, evidence):
    """The ablation of T in bins of sigma_flat."""
    for key in [key for key in ORACLES if evidence.seeds("E8", key)]:
        seeds = evidence.seeds("E8", key)
        bins = [select(groups, "training")[0].lists for groups in seeds.values()]
        x, values = np.log10(1e-6 * bins[0]["bin_sigma_npm3"]), np.array([one["bin_T"] for one in bins])
        line(ax, x, np.median(values, 0), name_with_seeds(evidence, "E8", key), **look(CONTROLLERS[key]))
        if len(seeds) > 1:
            caps(ax, x, values.min(0), values.max(0), CONTROLLERS[key].color)
    name_axes(ax, "Ablation of T by stiffness (Fig. 4 F)", "log10 of sigma_flat in MN/m³",
              "mean |change of an action|", True)


def attribution_figures(evidence):
    there = [key for key in ORACLES if evidence.seeds("E8", key)]
    sheet = Sheet("What the oracles' actions depend on (Fig. 4 E, F)", 2)
    groups = {"oracle-h": ("cmd", "h", "e", "T"), "oracle-o": ("cmd", "o", "e", "T")}
    bars(sheet.axes[0], ["cmd", "h or o", "e", "T"], [
        seed_bars(name_with_seeds(evidence, "E8", key), CONTROLLERS[key].color,
                  [oracle_ablation(evidence, key, name) for name in groups[key]])
        for key in there])
    name_axes(sheet.axes[0], "Ablation of groups of inputs (Fig. 4 E)", "", "mean |change of an action|", True)
    stiffness_chart(sheet.axes[1], evidence)
    yield Figure(
        "fig4ef",
        "\"much higher for the estimation group e_t compared with the terrain parameter group\"; \"Oracle(H) manifests "
        "less attribution for the terrain parameters than Oracle(O)\"; the values are not printed",
        "cmd: command; h: encoded history of Oracle(H); o: observation of Oracle(O); e: estimate; T: parameters of the "
        "ground. An action is a joint's target less its nominal position, in units of the network. Medians over the "
        "seeds; caps are the least and the greatest seed. Ten bins over all stiffnesses that the training draws, equal "
        "in the logarithm; the paper's axis is not printed.", sheet)
    sheet = Sheet("Parameters of the ground (Fig. 4 G, fig. S11)", 2)

    def of_parameters(key, name):
        return [oracle_value(evidence, key, name, place) for place in VARYING]
    if "oracle-o" in there:
        bars(sheet.axes[0], list(VARYING.values()), [
            seed_bars(joint, color, of_parameters("oracle-o", name))
            for (joint, name), color in zip(JOINTS.items(), (GREY, BLUE, ORANGE))])
    name_axes(sheet.axes[0], "Integrated gradients by joint, Oracle(O) (Fig. 4 G)", "", "mean |integrated gradient|",
              True)
    bars(sheet.axes[1], list(VARYING.values()), [
        seed_bars(name_with_seeds(evidence, "E8", key), CONTROLLERS[key].color, of_parameters(key, "alone"))
        for key in there])
    name_axes(sheet.axes[1], "Ablation of each parameter alone (fig. S11)", "", "mean |change of an action|", True)
    yield Figure(
        "fig4g",
        "sigma_flat and sigma_cone \"were more substantial than the other parts, such as the inertial force of the "
        "ground\"; the values are not printed",
        "Integrated gradients from the mean input, means of their magnitudes over the states and the four legs. Both "
        "grow with the range from which a parameter was drawn: see its deviation in the table. The rigid flag and the "
        "roughness of hard ground do not vary on soil.", sheet)


def ball_figure(ball):
    """`ball`: the drops in results.json, published and ours."""
    sheet = Sheet("A steel ball of 25.4 mm dropped on glass beads", 2)
    for ax, name in zip(sheet.axes, ("depth_mm", "time_ms")):
        line(ax, ball["published"]["impact_mps"], ball["published"][name], "Katsuragi and Durian 2007", GREY,
             dots=False)
        line(ax, ball["ours"]["impact_mps"], ball["ours"][name], "our contact law", BLUE, (0, (9, 4)))
    name_axes(sheet.axes[0], "Final depth", "speed at impact, m/s", "mm", True)
    name_axes(sheet.axes[1], "Stopping time", "speed at impact, m/s", "ms", True)
    return Figure("ball", "", "", sheet)


def learning_figure(models):
    """`models`: of results.json; each may have a learning curve."""
    sheet = Sheet("What each training had reached after how many transitions", 3, columns=3)
    columns = (("battery_alive", "Share of the battery alive"),
               ("battery_error", "Velocity error of the battery, relative"),
               ("battery_cost_of_transport", "Cost of transport of the battery"))
    for ax, (name, title) in zip(sheet.axes, columns):
        for model in models.values():
            if model["curve"].get(name):
                controller = CONTROLLERS[model["controller"]]
                line(ax, 1e-6 * np.array(model["curve"]["transitions"], float),
                     np.array(model["curve"][name], float), controller.name, dots=False, **look(controller))
        name_axes(ax, title, "million transitions", "", True)
    low, high = sheet.axes[2].get_ylim()
    sheet.axes[2].set_ylim(low, min(high, 3.0))  # before, a robot can hardly walk
    return Figure("curves", "not printed",
                  "A line for each seed; the battery is run on the grounds of each training. Costs end at 3.", sheet)
