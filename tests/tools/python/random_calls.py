# SPDX-License-Identifier: BSD-3-Clause
"""random_calls.py [SECONDS] [SEED]: random calls with good and bad arguments on everything that the package offers.
None may crash, hang, or raise anything but ValueError of one line. Under a sanitizer: README.md of tools/python."""

import gc
import math
import os
import random
import sys
import tempfile
import time

import numpy as np

import sandrunner
from sandrunner import Batch, Ground, Policy, Recording, VectorEnv

SECONDS = float(sys.argv[1]) if len(sys.argv) > 1 else 5.0
SEED = int(sys.argv[2]) if len(sys.argv) > 2 else 1
draw = random.Random(SEED)
numbers = np.random.default_rng(SEED)
FOLDER = tempfile.TemporaryDirectory()
ODD = [None, True, -1, 0, 1, 3, 2**70, 0.5, math.nan, math.inf, "", "a\nb", "raibo", "dry-sand", "\0", b"x", [], [1, 2],
       {}, {"a": 1}, (), object(), np.zeros(0), np.zeros((2, 2)), np.array("x"), np.float32(1), int]
KEYS = ["command.yaw_radps", "episode.length_s", "learner.window", "learner.block_envs", "ground.rigid_envs",
        "noise.level_high", "no.such.key", "terrain.friction", "terrain.kind", "", "policy.action_clip"]


def odd():
    return draw.choice(ODD)


def mostly(good):
    return good if draw.random() < 0.9 else odd()


def array(shape, dtype=np.float32):
    """Mostly an array of this shape; else another shape, type, order or content."""
    kind = draw.randrange(14)
    values = numbers.standard_normal(shape).astype(dtype)
    if kind == 0:
        values = values.reshape(-1)
    elif kind == 1:
        values = values[..., :-1]
    elif kind == 2:
        values = values.astype(draw.choice([np.float16, np.float64, np.int32, object, "U4"]))
    elif kind == 3 and values.size:
        values.flat[draw.randrange(values.size)] = draw.choice([np.nan, np.inf, -np.inf, 1e38])
    elif kind == 4:
        values = np.asfortranarray(values)
    elif kind == 5:
        values = np.broadcast_to(values[:1], shape)
    elif kind == 6:
        return odd()
    elif kind == 7:
        values = values.astype(values.dtype.newbyteorder())
    return values


def settings():
    return draw.choice([None, {draw.choice(KEYS): draw.choice([0, 1, 4, 16, 1e9, "linear", True, odd()])}, odd()])


def new_envs():
    count = draw.choice([16, 32, 64, 64, 128])
    usual = {"learner.block_envs": 16, "ground.rigid_envs": 8, "ground.patchy_envs": 8, "episode.length_s": 0.1}
    return VectorEnv(
        robot=mostly(draw.choice(["raibo", "go2"])), num_envs=mostly(count), seed=mostly(draw.randrange(9)), threads=mostly(draw.choice([1, 2])),
        settings=draw.choice([usual, usual, usual, settings()]),
        curriculum=draw.choice([True, False, {"speed_mps": 4.0, "ground": 1.0, "late": 1.0}, odd()]),
        actions=mostly(draw.choice(["joints", "modes"])), copy=draw.random() < 0.2, width=draw.choice([0, 1, 8, 16, 7]))


def use_envs(envs, kept):
    kind = draw.randrange(12)
    if kind < 6:
        scale = draw.choice([0.3, 3.0, 1e4])
        actions = array((envs.num_envs, 12))
        if isinstance(actions, np.ndarray) and actions.dtype == np.float32:
            actions = actions * np.float32(scale)
        for _ in range(draw.choice([1, 5, 30])):
            out = envs.step(actions)
        kept.append(out[0])
        kept.append(out[4]["reward_terms"])
    elif kind == 6:
        envs.reset(seed=draw.choice([None, 1, 5, odd()]))
    elif kind == 7:
        envs.set_curriculum(mostly(draw.random() * 4), mostly(draw.random()), mostly(1e6), mostly(draw.random()))
    elif kind == 8:
        recording = Recording(envs, mostly(0))
        while recording.add():
            envs.step(np.zeros((envs.num_envs, 12), np.float32))
        recording.write(mostly("run.html"), "x")
    elif kind == 9:
        kept.append((envs.statistics, envs.curriculum, envs.effective_settings))
        envs.raw_observation(numbers.standard_normal((3, 33)))
        envs.raw_estimate(numbers.standard_normal((3, 8)))
    elif kind == 10:
        tensors = dict(sandrunner.read_policy("raibo").tensors)
        tensors[draw.choice(list(tensors))] = draw.choice([array((12, 128)), odd()])
        sandrunner.write_policy(mostly("p.safetensors"), mostly(tensors), mostly(envs), provenance=mostly({}))
    elif draw.random() < 0.1:
        envs.close()


def new_batch():
    ground = draw.choice([*sandrunner.terrain_preset_names(), "moon"])
    return Batch(mostly("raibo"), mostly(draw.choice([1, 7, 20])), mostly(ground), settings(),
                 step_hz=mostly(draw.choice([2000.0, 4000.0])), threads=mostly(2))


def use_batch(batch, kept):
    kind = draw.randrange(6)
    robots = draw.choice([None, [0], [batch.num_robots - 1], np.arange(batch.num_robots), [99], odd()])
    if kind < 2:
        batch.targets[:] = numbers.standard_normal(batch.targets.shape) * draw.choice([0.3, 1e6, np.nan])
        batch.drive["kp"] = draw.choice([0.0, 50.0, 1e30, -50.0])
        batch.advance(mostly(draw.choice([1, 40, 400])))
        if draw.random() < 0.5:
            batch.targets[:] = 0.0
    elif kind == 2:
        state = batch.state.copy()
        name = draw.choice(list(state.dtype.names[:6]))
        state[name] += numbers.standard_normal(state[name].shape) * draw.choice([0.1, 1e20])
        if draw.random() < 0.3:
            state["contacts"]["region"] = draw.choice([0, 7, 8, -1, 0.5, np.nan])
            state["contacts"]["active"] = 1.0
        batch.set_state(mostly(state), robots)
    elif kind == 3:
        model = batch.model
        model["legs"]["thigh"]["mass"] *= draw.choice([0.0, 1.2, -1.0, 1e30])
        batch.set_model(mostly(model), robots)
    elif kind == 4:
        batch.set_ground(draw.choice([*sandrunner.terrain_preset_names(), "x"]), settings(), robots)
    else:
        batch.stand(robots)
    kept.append(batch.state)


def use_ground(kept):
    ground = Ground(draw.choice([*sandrunner.terrain_preset_names()]), settings(), foot_radius_m=mostly(0.03))
    contacts = ground.contacts(mostly(4))
    for _ in range(20):
        if draw.random() < 0.1:
            contacts["region"] = draw.choice([0, 7, 8, -1, 0.5, np.nan])
        if draw.random() < 0.1:
            contacts = mostly(contacts[::2])
        position = array((4, 3), np.float64)
        kept.append(ground.step(contacts, position, array((4, 3), np.float64), mostly(1e-3)))


def use_policy(kept):
    policy = Policy(mostly(draw.choice(["raibo", "go2"])))
    for count in (3, 3, 5):
        kept.append(policy.step(array((count, 33)), draw.choice([None, np.ones(count, bool), odd()])))


def main():
    end, calls, refused, things, kept = time.monotonic() + SECONDS, 0, 0, [], []
    while time.monotonic() < end:
        calls += 1
        try:
            kind = draw.randrange(20)
            if kind == 0 or not things:
                things.append(draw.choice([new_envs, new_envs, new_batch])())
                things = things[-6:]
            elif kind == 1:
                use_ground(kept)
            elif kind == 2:
                use_policy(kept)
            elif kind == 3:
                things.pop(draw.randrange(len(things)))
                gc.collect()
            else:
                thing = draw.choice(things)
                (use_envs if isinstance(thing, VectorEnv) else use_batch)(thing, kept)
        except ValueError as error:
            refused += 1
            if "\n" in str(error):
                raise
        kept = kept[-50:]
        if kept:
            repr(draw.choice(kept))  # reads memory that an object that is gone may have owned
    print(f"{calls} calls, {refused} refused")


if __name__ == "__main__":
    np.seterr(all="ignore")
    os.chdir(FOLDER.name)  # odd paths are written too
    main()
