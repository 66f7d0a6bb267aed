# SPDX-License-Identifier: BSD-3-Clause
"""Made-up measurements for the tests of tools/study/page."""
import base64

import numpy as np

import claims
from controllers import BEACH, COMMANDS, GRID, ORACLES, TRAINED
from evidence import Evidence, Group

GROUNDS = ("vinyl", "athletic-track", "grass")
TURNED = ("dry-sand", "wet-sand", "grass", "athletic-track", "vinyl")
USUAL = {"cot": 0.5, "limit_alone": 0.0, "depth_m": 0.08, "iqr_m": 0.05, "hind_over_front": 1.0, "peak_hfe_nm": 30.0,
         "peak_kfe_nm": 30.0, "extension_w": 20.0}


def ones(count, runs=16):
    return (np.arange(runs) < count).astype(float)


def at(value, command):
    """A figure may be a number or {command: number}."""
    return value.get(command, value.get("else")) if isinstance(value, dict) else value


def straight_runs(ground, commands, runs=16, successes=16, top_mps=3.0, alive=None, **figures):
    """Groups with this many successes at every command, this top speed, and these figures."""
    groups = []
    for v in commands:
        success = ones(at(successes, v), runs)
        values = {"speed_mps": v, **USUAL, **figures}
        groups.append(Group(ground, "", v, {
            "success": success, "strict_success": success, "alive": success if alive is None else ones(alive, runs),
            "end_speed_mps": top_mps + 0.001 * np.arange(runs),
            **{name: np.full(runs, float(at(value, v))) for name, value in values.items()}}))
    return groups


def turns(ground, rate=1.0, yaw=0.93, successes=16, cotu=1.0, alive=16):
    """Turns both ways."""
    return [Group(ground, "turn", way, {"success": ones(successes), "alive": ones(alive),
                                        "yaw_rate_radps": np.full(16, yaw), "cotu": np.full(16, cotu)})
            for way in (rate, -rate)]


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


def recovery(alive=16, recovery_s=0.3, swing_ratio=1.3, before=2.0, after=2.0):
    def many(value):
        return np.full(16, float(value))
    loose = [Group("dry-sand", scenario, 2.5, {"alive": ones(alive), "met": many(1.0), "recovery_s": many(recovery_s),
                                               "swing_ratio": many(swing_ratio)}) for scenario in ("half", "quarter")]
    return loose + [Group("dry-sand", "transition", v, {"alive": ones(alive), "speed_before_mps": many(before),
                                                        "speed_after_mps": many(after)}) for v in (2.0, 3.0, 4.0)]


def hidden_states(apart=8.0, states=120):
    """Of eight runs on four grounds, in clusters this far apart; too few states: none."""
    if states < 100:
        return [Group("all", lists={"states": np.array([float(states)])})]
    random, run = np.random.default_rng(1), np.arange(states) % 8
    phase = random.random(states)
    hidden = apart * np.eye(4, 6)[run // 2] + 0.3 * random.normal(size=(states, 6))
    hidden[:, 4:] = (2.0 if apart else 0.0) * np.column_stack([np.cos(2 * np.pi * phase), np.sin(2 * np.pi * phase)])
    packed = base64.b64encode(hidden.astype("<f4").tobytes()).decode()
    return [Group("all", lists={"states": np.array([float(states)]), "run": run.astype(float), "phase": phase,
                                "ground_of_run": np.arange(8) // 2.0}, packed={"hidden": packed, "estimate": packed})]


def foam(alive=16):
    return [Group("memory-foam", "", 0.5, {"alive": ones(alive)})]


def grid(fails=False):
    """All cells alike, or black."""
    cell = np.full(100, np.nan if fails else 0.03)
    return [Group("grid", "cells", lists={"static_depth_m": 0.05 - 1e-4 * np.arange(100), "clearance_m": cell,
                                          "reward": np.full(100, 0.0 if fails else 4.0)}),
            Group("grid", "robots", runs={name: np.full(16, np.nan if fails and "slope" in name else value)
                                          for name, value in (("reward", 0.0 if fails else 4.0), ("slope_flat_m", -0.02),
                                                              ("slope_cone_m", -0.02))}),
            Group("grid", "terms", lists={name: np.array([value]) for name, value in (
                ("reward_velocity", 0.5 if fails else 4.5), ("penalty_fall", -0.75), ("penalty_torque", -0.001))})]


def oracle(terrain=0.1, estimate=0.3, bins=(0.1, 0.2), gradients=(0.3, 0.2, 0.1)):
    """Actions that depend on T and e by this much, in the bins of sigma_flat by `bins`, and on
    sigma_flat, sigma_cone and the inertial factor by `gradients`."""
    lists = {name: np.array([0.0, gradients[0], gradients[1], 0.0, gradients[2]])
             for name in ("gradient_haa", "gradient_hfe", "gradient_kfe")}
    return [Group("training", runs={"T": terrain + 0.001 * np.arange(10), "e": np.full(10, estimate)},
                  lists={"bin_T": np.array(bins), **lists})]


def on_other_grounds(successes=16, **figures):
    """E3 of one controller."""
    return ([g for ground in GROUNDS for g in straight_runs(ground, COMMANDS, successes=successes, **figures)] +
            [g for ground in TURNED for g in turns(ground)])


def everything(failing=()):
    """Evidence of all experiments with seeds 1 and 2, contact models included. All controllers are
    alike, but those that fail everything outside of their home."""
    def of(controllers, make):
        """`make` has the number of successes; who have as many share their groups."""
        groups = {n: make(n) for n in (0, 16)}
        return {c: dict.fromkeys((1, 2), groups[0 if c in failing else 16]) for c in controllers}

    def lost(n):
        return {} if n else dict.fromkeys(("recovery_s", "swing_ratio", "before", "after"), np.nan)
    home = straight_runs("own", (1.0, 2.0, 3.0))
    return Evidence({
        "fairness": of(TRAINED, lambda n: home),
        "E1": of(BEACH, lambda n: straight_runs("beach", COMMANDS, successes=n)),
        "E2": of(["ours"], lambda n: recovery(n, **lost(n))),
        "E3": of(["ours", "env-rigid"], on_other_grounds),
        "E4": of(["ours"], lambda n: hidden_states(states=120 if n else 0)),
        "E5": of(("ours", "env-rigid", "pl-gm", "pl-rigid"), lambda n: [g for rate in (1.0, 2.0) for g in turns(
            "air-mattress", rate, successes=n, alive=n)]),
        "E6": of(["ours", "env-rigid"], foam),
        "E7": of(GRID, lambda n: grid(fails=not n)),
        "E8": of(ORACLES, lambda n: oracle())},
        {"ratio": 20.0, "spread_cone": 0.42, "spread_drft": 0.39, "spread_planar": 0.40})


def verdict(claim_id, evidence):
    return str(judgement(claim_id, evidence))


def judgement(claim_id, evidence):
    found = [c for c in claims.read_claims(claims.CLAIMS_FILE.read_text()) if c.id == claim_id]
    return claims.judge(found[0], evidence)
