# SPDX-License-Identifier: BSD-3-Clause
"""The rules of claims 52 to 58, 60 to 62 and 68 on the grid of stiffnesses."""
import numpy as np

from controllers import GRID, name_of
from evidence import grid_figure, grid_medians, median, soft_and_stiff
from rules import rule
from terms import LEAST_PAIRS, is_about, is_far_from, mean_interval, printed

SLOPES = ("slope_flat_m", "slope_cone_m")
NOTHING = False, False, ""


def is_papers(case):
    """Whether the grid is the paper's. If not, the claims about its cells cannot be told."""
    papers = len(grid_medians(case.evidence, "ours", "reward")) == 100
    case.too_few = case.too_few or not papers
    return papers


def reward(case, controller):
    return grid_figure(case.evidence, controller, "reward")


def reward_text(case, *controllers):
    return ", ".join(f"{name_of(c)} {printed(reward(case, c))}" for c in controllers)


def slope_text(case, *controllers):
    """mm a decade of sigma_flat and of sigma_cone."""
    return ", ".join(name_of(c) + " " + " and ".join(
        printed(grid_figure(case.evidence, c, name), 1e3, 1) for name in SLOPES) for c in controllers) + " mm a decade"


@rule("52", "E7", "ours env-rigid pl-rigid")
def loses_on_soft_ground(case):
    if not is_papers(case):
        return NOTHING
    def lost(groups):
        soft, stiff = soft_and_stiff(groups, "reward")
        return 1.0 - soft / stiff
    figures = {c: case.evidence.figure("E7", c, lost) for c in ("ours", "env-rigid", "pl-rigid")}
    more = [median(figures[c]) - median(figures["ours"]) for c in ("env-rigid", "pl-rigid")]
    return (all(m >= 0.30 for m in more), all(m <= 0.0 for m in more),
            "lost: " + ", ".join(f"{name_of(c)} {printed(figure, 100.0, 0)} %" for c, figure in figures.items()))


def adapts_less(case, *others):
    """How much higher on softer ground the feet of all these are, against those of Ours."""
    if not is_papers(case):
        return NOTHING
    pairs = [[-median(grid_figure(case.evidence, c, name)) for c in (other, "ours")]
             for other in others for name in SLOPES]
    return (all(theirs < 0.5 * ours and ours > 0.0 for theirs, ours in pairs),
            all(theirs > ours for theirs, ours in pairs),
            slope_text(case, "ours", *others))


rule("53", "E7", "ours env-rigid pl-rigid")(lambda case: adapts_less(case, "env-rigid", "pl-rigid"))
rule("58", "E7", "ours tcn")(lambda case: adapts_less(case, "tcn"))


@rule("54", "E7", "ours pl-gm")
def both_adapt(case):
    if not is_papers(case):
        return NOTHING
    all_adapt, one_does_not = True, False
    for controller in ("ours", "pl-gm"):
        include_zero = []
        for name in SLOPES:
            slope = grid_figure(case.evidence, controller, name)
            all_adapt = all_adapt and median(slope) <= -0.005
            for value in slope.values():
                n, low, high = mean_interval(value.runs)
                include_zero.append(low <= 0.0 <= high)
                all_adapt = all_adapt and n >= LEAST_PAIRS and not include_zero[-1]
        one_does_not = one_does_not or all(include_zero)
    return all_adapt, one_does_not, slope_text(case, "ours", "pl-gm")


def in_most_cells(case, name, better):
    """In how many cells `better(ours, PL/Env-GM)` holds; not where one of them has no value."""
    if not is_papers(case):
        return NOTHING
    ours, theirs = (grid_medians(case.evidence, c, name) for c in ("ours", "pl-gm"))
    cells = better(ours, theirs).sum()
    return cells >= 95, cells < 50, f"in {cells} of {len(ours)} cells"


rule("55", "E7", "ours pl-gm")(lambda case: in_most_cells(case, "reward", np.greater))
rule("56", "E7", "ours pl-gm")(lambda case: in_most_cells(case, "clearance_m", np.less))


@rule("57", "E7", "ours tcn")
def recurrent_is_better(case):
    ours, tcn = reward(case, "ours"), reward(case, "tcn")
    return case.above(ours, tcn), case.above(tcn, ours), reward_text(case, "ours", "tcn")


@rule("60", "E7", "ours teacher-gm oracle-h oracle-o")
def teacher_is_worse(case):
    teacher, others = reward(case, "teacher-gm"), [reward(case, c) for c in ("ours", "oracle-h", "oracle-o")]
    above, below = [case.above(other, teacher) for other in others], [case.above(teacher, other) for other in others]
    return all(above), any(below), reward_text(case, "teacher-gm", "ours", "oracle-h", "oracle-o")


@rule("61", "E7", " ".join(GRID))
def oracle_h_is_best(case):
    h, o = reward(case, "oracle-h"), reward(case, "oracle-o")
    others = {c: median(reward(case, c)) for c in GRID if c != "oracle-h"}
    best_other = max(others, key=others.get)
    text = reward_text(case, "oracle-h", "oracle-o")
    if best_other != "oracle-o":
        text += f"; best of the others: {reward_text(case, best_other)}"
    is_best = all(median(h) > other for other in others.values())
    return case.above_by_share(h, o, 0.03) and is_best, case.above(o, h), text


@rule("62", "E7", "ours oracle-o")
def oracle_o_is_like_ours(case):
    o, ours = reward(case, "oracle-o"), median(reward(case, "ours"))
    return is_about(o, ours, 0.03), is_far_from(o, ours, 0.03), reward_text(case, "oracle-o", "ours")


@rule("68", "E7", "pl-gm teacher-gm")
def student_is_bounded(case):
    student, teacher = reward(case, "pl-gm"), reward(case, "teacher-gm")
    return median(student) <= median(teacher), case.above(student, teacher), reward_text(case, "pl-gm", "teacher-gm")
