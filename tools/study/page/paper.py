# SPDX-License-Identifier: BSD-3-Clause
"""Numbers that the paper prints: Choi et al., "Learning quadrupedal locomotion on deformable
terrain", Science Robotics 8 (2023). What it shows in pictures only is not here."""
from dataclasses import dataclass

from evidence import NAN


@dataclass(frozen=True)
class BeachRow:
    """Table 1 and the success rates of the text ("Beach sand")."""
    success: float  # of 40 trials
    average_mps: float  # "Maximum average speed over 5 m"
    top_mps: float  # "Maximum speed after acceleration"


BEACH = {
    "ours": BeachRow(1.0, 2.427, 3.028),
    "env-rigid": BeachRow(0.5, 1.163, 1.234),
    "env-quasistatic": BeachRow(NAN, 1.866, 1.959),
    "env-linear": BeachRow(0.175, 1.101, 1.658),
    "pl-gm": BeachRow(0.725, 1.838, 2.009),
    "pl-rigid": BeachRow(0.375, 1.567, 1.652),
}

# "the maximum speed of Ours was 83.3 and 50.7% faster" than PL/Env-Rigid's and PL/Env-GM's.
FASTER_THAN_PL_RIGID, FASTER_THAN_PL_GM = 0.833, 0.507
# P_mech^E "was 52.5% larger for the PL/Env-Rigid than the Env-Rigid".
EXTENSION_EXCESS = 0.525

# "up to 3.13, 3.62, and 3.76 m/s on grass, athletic track, and vinyl tile".
TOP_MPS = {"grass": 3.13, "athletic-track": 3.62, "vinyl": 3.76}
# "6.1 and 10.1% lower maximum speed than our controller on the running track and grass".
RIGID_LOWER = {"athletic-track": 0.061, "grass": 0.101}

# Yaw rates, rad/s: on dry sand; "in all terrains"; on the air mattress at commands of 1 and 2.
YAW_SAND, YAW_ALL, YAW_MATTRESS = 0.92, 0.94, {1.0: 0.71, 2.0: 1.54}
