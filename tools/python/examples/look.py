#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Rolls a policy out in the training environments and writes one robot's episode as a page for a browser."""

import argparse

import numpy as np
from sandrunner import Policy, Recording, VectorEnv


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", default="raibo", help="raibo, go2 or a robot file")
    parser.add_argument("--policy", help="policy file (default: the one that ships for the robot)")
    parser.add_argument("--out", default="run.html")
    parser.add_argument("--seconds", type=float, default=6.0, help="length of an episode")
    parser.add_argument("--speed", type=float, default=2.0, help="fastest command, m/s")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    envs = VectorEnv(
        options.robot,
        num_envs=64,
        seed=options.seed,
        settings={"episode.length_s": options.seconds, "command.forward_share": 1.0, "command.zero_share": 0.0,
                  "command.in_place_share": 0.0},
        curriculum={"speed_mps": options.speed, "ground": 0.5},
    )
    policy = Policy(options.policy or options.robot)
    observation, info = envs.reset()
    # Episodes begin out of step: wait for the start of one.
    while not (info["reset"] & info["_final_obs"]).any():
        observation, *_, info = envs.step(policy.act(envs, observation, info["reset"]))
    robot = int(np.argmax(info["reset"] & info["_final_obs"]))
    recording, steps = Recording(envs, robot), 0
    info["_final_obs"][:] = False  # of the episode before
    while recording.add():
        observation, _, terminated, _, info = envs.step(policy.act(envs, observation, info["reset"]))
        steps += 1
    recording.write(options.out, f"robot {robot}")
    print(f"{options.out}: {steps / 100:.2f} s, {'a fall' if terminated[robot] else 'no fall'}")


if __name__ == "__main__":
    main()
