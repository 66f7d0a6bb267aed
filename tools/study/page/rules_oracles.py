# SPDX-License-Identifier: BSD-3-Clause
"""The rules of CLAIMS.md for what the oracles' actions depend on."""
import numpy as np

from controllers import ORACLES, name_of
from evidence import mean, median, oracle_ablation, oracle_value, select
from rules import rule
from terms import printed, ratio

# Places among the parameters of the ground; lists of their mean |integrated gradients|.
SIGMA_FLAT, SIGMA_CONE, INERTIA = 1, 2, 4
JOINTS = {"HAA": "gradient_haa", "HFE": "gradient_hfe", "KFE": "gradient_kfe"}


@rule("59", "E8", "oracle-h oracle-o")
def estimate_matters_more(case):
    times = {c: ratio(oracle_ablation(case.evidence, c, "e"), oracle_ablation(case.evidence, c, "T")) for c in ORACLES}
    return (all(median(t) >= 2.0 for t in times.values()), all(median(t) < 1.0 for t in times.values()),
            ", ".join(f"{name_of(c)} {printed(t)}" for c, t in times.items()) + " times that of T")


@rule("63", "E8", "oracle-h oracle-o")
def history_replaces_terrain(case):
    h, o = (oracle_ablation(case.evidence, c, "T") for c in ORACLES)
    return case.above(o, h), case.above(h, o), f"Oracle(H) {printed(h, 1.0, 4)}, Oracle(O) {printed(o, 1.0, 4)}"


@rule("64", "E8", "oracle-h oracle-o")
def depends_on_stiffness(case):
    def spread(groups):
        bins = select(groups, "training")[0].lists["bin_T"]
        return (np.fmax.reduce(bins) - np.fmin.reduce(bins)) / mean(bins)
    h, o = (case.evidence.figure("E8", c, spread) for c in ORACLES)
    return median(o) > 1.2 * median(h), median(o) < median(h), f"Oracle(H) {printed(h)}, Oracle(O) {printed(o)}"


@rule("65", "E8", "oracle-o")
def depth_matters_more_than_inertia(case):
    larger, smaller, texts = True, True, []
    for joint, name in JOINTS.items():
        flat, cone, inertia = (oracle_value(case.evidence, "oracle-o", name, i)
                               for i in (SIGMA_FLAT, SIGMA_CONE, INERTIA))
        larger = larger and min(median(flat), median(cone)) > median(inertia)
        smaller = smaller and max(median(flat), median(cone)) < median(inertia)
        texts.append(f"{joint} {printed(flat, 1.0, 4)}, {printed(cone, 1.0, 4)} against {printed(inertia, 1.0, 4)}")
    return larger, smaller, "; ".join(texts)
