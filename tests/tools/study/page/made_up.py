# SPDX-License-Identifier: BSD-3-Clause
"""Made-up measurements for the tests of tools/study/page."""
import numpy as np

import claims
from controllers import COMMANDS
from evidence import Evidence, Group



def straight_runs(ground, commands, runs=16, successes=16, top_mps=3.0, alive=None):
    """Groups with this many successes at every command, and this top speed."""
    success = (np.arange(runs) < successes).astype(float)
    return [Group(ground, "", v, {
        "success": success, "alive": success if alive is None else (np.arange(runs) < alive).astype(float),
        "speed_mps": np.full(runs, v), "end_speed_mps": top_mps + 0.001 * np.arange(runs),
        "cot": np.full(runs, 0.5), "limit_alone": np.zeros(runs), "depth_m": np.full(runs, 0.05)}) for v in commands]


def on_the_beach(controllers):
    """Evidence of E1 with seeds 1 and 2; `controllers`: arguments of straight_runs, and
    alive_at_home, seeds."""
    evidence = Evidence({"E1": {}, "fairness": {}})
    for controller, arguments in controllers.items():
        arguments = dict(arguments)
        seeds, home = arguments.pop("seeds", (1, 2)), arguments.pop("alive_at_home", 16)
        evidence.measured["E1"][controller] = {s: straight_runs("beach", COMMANDS, **arguments) for s in seeds}
        evidence.measured["fairness"][controller] = dict.fromkeys(
            seeds, straight_runs("own", (1.0, 2.0, 3.0), alive=home))
    return evidence


def verdict(claim_id, evidence):
    found = [c for c in claims.read_claims(claims.CLAIMS_FILE.read_text()) if c.id == claim_id]
    return str(claims.judge(found[0], evidence))
