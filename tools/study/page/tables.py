# SPDX-License-Identifier: BSD-3-Clause
"""The tables of the page, as HTML."""
import math

import numpy as np

import hidden_state
import paper
from controllers import BEACH, CONTROLLERS, GRID, ORACLES, TRAINED, name_of
from evidence import (NAN, Value, greatest_of_first_five, grid_figure, grid_list, mean, mean_value, median,
                      oracle_ablation, oracle_value, run_values, select, soft_and_stiff, success_rate)
from markup import NOT_RUN, escaped, named, table
from rules_oracles import JOINTS
from terms import mean_interval, printed, rate_interval, ratio

# Parameters of the ground and what the actor sees of them (train::terrain_features).
PARAMETERS = (("rigid", "1 on hard ground, else 0"),
              ("&sigma;_flat", "log10(&sigma;_flat / 3 MN/m&sup3;)"),
              ("&sigma;_cone", "2 log10(&sigma;_cone / 0.3 MN/m&sup3;)"),
              ("friction", "3 (&mu; - 0.75)"),
              ("inertia", "2 (factor - 0.65)"),
              ("roughness", "100 roughness / m"),
              ("recruitment", "(&nu; - 2) / 0.3"),
              ("cone angle", "(&theta; - 60&deg;) / 4&deg;"),
              ("stroke stiffness", "(k_h - 225 N/m) / 175 N/m"),
              ("stroke damping", "(b_h - 2 N s/m) / 2 N s/m"))


# What the terms of the reward leave: the penalties end at a floor, and a diverged robot has none.
FLOOR = "given back by the floor of the penalties"


def controller_table(evidence, experiment, keys, heads, cells):
    """A row for each controller: its name, then `cells(key, its groups by seed)`."""
    rows = []
    for key in keys:
        seeds = evidence.seeds(experiment, key)
        row = [named(CONTROLLERS[key])] + (cells(key, seeds) if seeds else [NOT_RUN])
        rows.append(row + [""] * (len(heads) - len(row)))
    return table(heads, rows)


def numbers(seeds):
    return ", ".join(str(seed) for seed in seeds)


def mean_figure(evidence, experiment, key, ground, scenario, v, name):
    return evidence.figure(experiment, key, lambda g: mean_value(select(g, ground, scenario, v, v), name))


def fairness_table(evidence):
    def cells(key, seeds):
        alive = [printed(mean_figure(evidence, "fairness", key, "own", "", v, "alive"), 100.0, 0) for v in (1, 2, 3)]
        return [numbers(seeds), *alive,
                "yes" if evidence.is_competent(key) else '<span class="contradicts">no</span>']
    return controller_table(evidence, "fairness", TRAINED, [
        "controller", "seeds", "alive at 1 m/s, %", "at 2 m/s, %", "at 3 m/s, %", "competently trained"], cells)


def beach_cells(evidence, key):
    """Success as the paper counted it, with its interval, and strictly; average and top speed: of
    runs 0 to 4, and the greatest of the means over all successful runs, with its interval."""
    def of(name):
        return evidence.figure("E1", key, lambda g: success_rate(select(g, "beach"), name))

    def greatest(name):
        return printed(evidence.figure("E1", key, lambda g: greatest_of_first_five(select(g, "beach"), name)), 1.0, 3)

    def at_best(name):
        """With the interval of the first seed."""
        def best(groups):
            values = [mean_value([one], name, True) for one in select(groups, "beach")]
            return max((v for v in values if not math.isnan(v.value)), key=lambda v: v.value, default=Value(NAN))
        figure = evidence.figure("E1", key, best)
        _, low, high = mean_interval(next(iter(figure.values())).runs)
        return printed(figure, 1.0, 3) + ("" if math.isnan(low) else f" ({low:.2f} to {high:.2f})")
    runs = run_values(select(next(iter(evidence.seeds("E1", key).values())), "beach"), "success")
    low, high = rate_interval(runs)
    return [f"{printed(of('success'), 100.0, 1)} ({100 * low:.0f} to {100 * high:.0f})",
            printed(of("strict_success"), 100.0, 1), greatest("speed_mps"), at_best("speed_mps"),
            greatest("end_speed_mps"), at_best("end_speed_mps")]


def beach_table(evidence):
    """Table 1 of the paper."""
    def theirs(value, scale, digits):
        return "not printed" if math.isnan(value) else f"{scale * value:.{digits}f}"
    rows = []
    for key in BEACH + ["published"] * bool(evidence.seeds("E1", "published")):
        seeds, row = evidence.seeds("E1", key), paper.BEACH.get(key)
        cells = beach_cells(evidence, key) if seeds else [NOT_RUN] * 6
        printed_ones = ([theirs(row.success, 100.0, 1), theirs(row.average_mps, 1.0, 3), theirs(row.top_mps, 1.0, 3)]
                        if row else [""] * 3)  # the paper's numbers are those of Ours
        rows.append([named(CONTROLLERS[key]), (numbers(seeds) or NOT_RUN) if row else "", printed_ones[0], *cells[:2],
                     printed_ones[1], *cells[2:4], printed_ones[2], *cells[4:]])
    return table(["controller", "seeds", "success, %: paper", "ours", "ours, strict", "average, m/s: paper", "ours",
                  "ours, mean of all runs", "top, m/s: paper", "ours", "ours, mean of all runs"], rows)


def recovery_table(evidence):
    def cell(scenario, v, name, scale, digits):
        return printed(mean_figure(evidence, "E2", "ours", "dry-sand", scenario, v, name), scale, digits)
    loose = [[scenario, cell(scenario, 2.5, "alive", 100.0, 1), cell(scenario, 2.5, "met", 100.0, 1),
              cell(scenario, 2.5, "recovery_s", 1.0, 2), cell(scenario, 2.5, "swing_ratio", 1.0, 2)]
             for scenario in ("half", "quarter")]
    wet = [[f"{v:.0f}", cell("transition", v, "alive", 100.0, 1), cell("transition", v, "speed_before_mps", 1.0, 2),
            cell("transition", v, "speed_after_mps", 1.0, 2)] for v in (2.0, 3.0, 4.0)]
    return (table(["stiffness under one stance, 2.5 m/s", "alive, %", "met it, %", "time until 90 % of the speed, s",
                   "next swing over usual"], loose) +
            table(["from dry onto wet sand, command, m/s", "alive, %", "speed before, m/s", "speed after, m/s"], wet))


def hidden_state_table(evidence):
    rows = [("share of hidden states whose ground they tell, % (chance: 25)", "told", 100.0, 1),
            ("the same with grounds shuffled over runs, 95th percentile, %", "told_shuffled", 100.0, 1),
            ("share of estimates whose ground they tell, %", "told_by_estimate", 100.0, 1),
            ("phase of the gait: length of the mean of exp(i error)", "phase_told", 1.0, 3)]
    return table(["ten nearest neighbours in other runs", "value"], [
        [text, printed(hidden_state.figure(evidence, name), scale, digits)] for text, name, scale, digits in rows])


def foam_table(evidence):
    def cells(key, _):
        return [printed(mean_figure(evidence, "E6", key, "memory-foam", "", 0.5, name), scale, digits)
                for name, scale, digits in (("alive", 100.0, 1), ("speed_before_mps", 1.0, 2),
                                            ("speed_after_mps", 1.0, 2))]
    return controller_table(evidence, "E6", ["ours", "env-rigid"],
                            ["controller", "alive, %", "speed before, m/s", "speed after, m/s"], cells)


def grid_table(evidence):
    """Stands for table S1 of the paper."""
    def cells(key, seeds):
        def of_cells(of, scale=1.0, digits=2):
            return printed(evidence.figure("E7", key, of), scale, digits)

        def slope(name):
            figure = grid_figure(evidence, key, name)
            _, low, high = mean_interval(next(iter(figure.values())).runs)
            return f"{printed(figure, 1e3, 1)} ({1e3 * low:.1f} to {1e3 * high:.1f})"
        return [numbers(seeds), printed(grid_figure(evidence, key, "reward")),
                of_cells(lambda g: np.fmin.reduce(grid_list(g, "reward"))),
                of_cells(lambda g: soft_and_stiff(g, "reward")[0]), of_cells(lambda g: soft_and_stiff(g, "reward")[1]),
                printed(grid_figure(evidence, key, "success"), 100.0, 1),
                of_cells(lambda g: np.fmin.reduce(grid_list(g, "success")), 100.0, 0),
                of_cells(lambda g: mean(grid_list(g, "clearance_m")), 1e3, 1), slope("slope_flat_m"),
                slope("slope_cone_m")]
    return controller_table(evidence, "E7", GRID, [
        "controller", "seeds", "mean reward", "worst cell", "softest quarter", "stiffest quarter", "success, %",
        "worst cell, %", "clearance, mm", "mm a decade of sigma_flat", "mm a decade of sigma_cone"], cells)


def reward_terms_table(evidence):
    """The mean reward of a step by term, of those that matter; medians over the seeds. Empty if the
    terms were not kept."""
    parts = {}  # by name, then by controller
    for key in GRID:
        for groups in evidence.seeds("E7", key).values():
            kept = select(groups, "grid", "terms")
            if not kept:
                return ""
            of_seed = {name: values[0] for name, values in kept[0].lists.items()}
            whole = mean_value(select(groups, "grid", "robots"), "reward").value
            of_seed[FLOOR], of_seed["all"] = whole - sum(of_seed.values()), whole
            for name, value in of_seed.items():
                parts.setdefault(name, {}).setdefault(key, []).append(value)
    ran = [key for key in GRID if evidence.seeds("E7", key)]
    rows = []
    for name in [*(name for name in parts if name not in (FLOOR, "all")), FLOOR, "all"]:
        values = [median(parts[name][key]) for key in ran]
        kind, _, term = name.rpartition("_") if name in (FLOOR, "all") else name.partition("_")
        if name in (FLOOR, "all") or max(map(abs, values)) >= 0.005:
            rows.append([kind, term.replace("_", " "), *(f"{value:.2f}" for value in values)])
    return table(["", "term", *(name_of(key) for key in ran)], rows)


def states_table(evidence):
    """What the figures of E8 rest on, and whether integrated gradients add up."""
    rows = []
    for key in ORACLES:
        seeds = evidence.seeds("E8", key)
        cells = [printed(oracle_value(evidence, key, name), scale, digits) for name, scale, digits in (
            ("robots", 1.0, 0), ("states", 1.0, 0), ("fell", 100.0, 1), ("gap_median", 100.0, 2),
            ("gap_p99", 100.0, 2))] if seeds else [""] * 5
        rows.append([name_of(key), numbers(seeds) or NOT_RUN, *cells])
    return table(["controller", "seeds", "robots, 4 s each", "states", "robots that fell, %",
                  "integrated gradients miss the change: median, %", "99th percentile, %"], rows)


def parameter_table(evidence):
    columns = [("oracle-o", "deviation over the states", "deviation", None)]
    columns += [("oracle-o", joint if i else f"Oracle(O), mean |IG|: {joint}", name, None)
                for i, (joint, name) in enumerate(JOINTS.items())]
    columns += [("oracle-o", "of KFE, over the deviation", "gradient_kfe", "deviation"),
                ("oracle-o", "alone: Oracle(O)", "alone", None), ("oracle-h", "Oracle(H)", "alone", None)]

    def cell(place, key, name, over):
        if not evidence.seeds("E8", key):
            return NOT_RUN
        figure = oracle_value(evidence, key, name, place)
        return printed(ratio(figure, oracle_value(evidence, key, over, place)) if over else figure, 1.0, 4)
    return table(["parameter", "as the actor sees it"] + [title for _, title, _, _ in columns], [
        [*parameter, *(cell(place, key, name, over) for key, _, name, over in columns)]
        for place, parameter in enumerate(PARAMETERS)])


def attribution_tables(evidence):
    rows = []
    for key, second in zip(ORACLES, ("h", "o")):
        if evidence.seeds("E8", key):
            figures = {name: oracle_ablation(evidence, key, name) for name in ("cmd", second, "e", "T")}
            rows.append([name_of(key), *(printed(figure, 1.0, 4) for figure in figures.values()),
                         printed(ratio(figures["e"], figures["T"]))])
    return (states_table(evidence) +
            table(["mean |change of an action| without", "cmd", "h or o", "e", "T", "e over T"], rows) +
            parameter_table(evidence) +
            '<p class="note">|IG|: magnitude of the integrated gradient; alone: ablation of this parameter alone. Both '
            "are of an action.</p>\n")


def contact_table(contact):
    return table(["figure", "paper", "ours"], [
        ["time of DRFT over that of the cone model", "about 20", f"{contact['ratio']:.1f}"],
        ["final depths, cone model, mm", "not printed", escaped(contact["cone_mm"])],
        ["final depths, DRFT in space, mm", "not printed", escaped(contact["drft_mm"])],
        ["final depths, DRFT in a plane, mm", "not printed", escaped(contact["planar_mm"])],
        ["processor", "", escaped(contact["processor"])]])


def anchor_table(anchors):
    """`anchors`: the experiments with the ground in results.json."""
    return table(["experiment", "source", "quantity", "published", "ours", "deviation"], [
        [escaped(a["experiment"]), escaped(a["source"]), escaped(a["quantity"]),
         f"{a['published']:.{a['digits']}f}", f"{a['ours']:.{a['digits']}f}",
         f"{100 * (a['ours'] / a['published'] - 1):+.1f} %"] for a in anchors])


def origin_table(models):
    """Where each model of results.json comes from."""
    keys = ("seed", "transitions", "core_hours", "processor", "commit", "origin")
    return table(["model", "length of the training, million transitions", "seed", "taken after transitions",
                  "core-hours until then", "processor", "commit", "origin", "hash of the file"], [
        [name, f"{1e-6 * model['length']:.4g}", *(escaped(model["provenance"].get(key, "")) for key in keys),
         model["hash"]] for name, model in models.items()])


def settings_table(models):
    """The settings of each controller's training that differ from the trainer's own, with the seeds
    that have them."""
    rows = []
    for key in CONTROLLERS:
        own = [model for model in models.values() if model["controller"] == key and "config" in model["provenance"]]
        seeds = {}
        for model in own:
            for difference in model["settings"]:
                seeds.setdefault((difference["key"], difference["value"], difference["usual"]), []).append(
                    model["seed"])
        rows += [[name_of(key), escaped(setting), escaped(value), escaped(usual) or "no such setting",
                  numbers(of_seeds)] for (setting, value, usual), of_seeds in sorted(seeds.items())]
        if own and not seeds:
            rows.append([name_of(key), "none", "", "", numbers(model["seed"] for model in own)])
    return table(["controller", "setting", "value", "usual value", "seeds"], rows)
