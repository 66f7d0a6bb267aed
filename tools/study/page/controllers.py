# SPDX-License-Identifier: BSD-3-Clause
"""The paper's controllers: their names, and how each looks in every figure."""
from dataclasses import dataclass


@dataclass(frozen=True)
class Controller:
    key: str  # of its files and in results.json
    name: str  # the paper's
    color: tuple
    dashes: tuple = ()  # lengths of strokes and gaps; empty: a solid line


# In the order of the tables. "published" is the authors' own policy (--published), which has no
# part in a verdict.
CONTROLLERS = {c.key: c for c in (
    Controller("ours", "Ours", (0.05, 0.32, 0.70)),
    Controller("env-rigid", "Env-Rigid", (0.84, 0.37, 0.00), (9, 4)),
    Controller("env-quasistatic", "Env-Quasistatic", (0.00, 0.55, 0.40), (3, 3)),
    Controller("env-linear", "Env-Linear", (0.58, 0.25, 0.65), (9, 3, 2, 3)),
    Controller("pl-gm", "PL/Env-GM", (0.80, 0.10, 0.20), (14, 4)),
    Controller("pl-rigid", "PL/Env-Rigid", (0.45, 0.29, 0.15), (5, 5)),
    Controller("teacher-gm", "Teacher/Env-GM", (0.35, 0.35, 0.38)),
    Controller("teacher-rigid", "Teacher/Env-Rigid", (0.60, 0.60, 0.62), (9, 4)),
    Controller("oracle-h", "Oracle(H)", (0.00, 0.60, 0.75), (12, 3, 2, 3)),
    Controller("oracle-o", "Oracle(O)", (0.85, 0.60, 0.05), (3, 3)),
    Controller("tcn", "TCN", (0.75, 0.25, 0.50), (2, 4)),
    Controller("published", "Authors' network", (0.10, 0.10, 0.10), (2, 3)),
)}
TRAINED = [key for key in CONTROLLERS if key != "published"]
# Of Table 1 and Fig. 2, of Fig. 4 A to D, of Fig. 4 E to G.
BEACH = ["ours", "env-rigid", "env-quasistatic", "env-linear", "pl-gm", "pl-rigid"]
GRID = ["ours", "env-rigid", "pl-gm", "pl-rigid", "teacher-gm", "oracle-h", "oracle-o", "tcn"]
ORACLES = ["oracle-h", "oracle-o"]

COMMANDS = [0.5 * i for i in range(1, 9)]  # of the paper's straight runs, m/s


def name_of(key):
    return CONTROLLERS[key].name
