#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Transitions per second from Python over those of the same loop in C++, in turns within one run. Exits with 1 if the
ratio of the medians is below 0.95."""

import argparse
import statistics
import sys
import time

import numpy as np
from sandrunner import VectorEnv, _native

LEAST = 0.95


def ratio(envs: int, threads: int, rounds: int, steps: int) -> float:
    python = VectorEnv(num_envs=envs, threads=threads)
    loop = _native.TaskLoop(python._native, seed=1)
    actions = (0.3 * np.random.default_rng(0).standard_normal((envs, 12))).astype(np.float32)
    seconds: tuple[list[float], list[float]] = ([], [])
    for _ in range(rounds):
        start = time.perf_counter()
        for _ in range(steps):
            python.step(actions)
        seconds[0].append(time.perf_counter() - start)
        seconds[1].append(loop.run(actions, steps))
    rates = [envs * steps / statistics.median(s) for s in seconds]
    print(f"{envs} environments, {threads} threads: Python {rates[0]:,.0f} transitions/s, C++ {rates[1]:,.0f}, "
          f"ratio {rates[0] / rates[1]:.3f}", flush=True)
    return rates[0] / rates[1]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--envs", type=int, nargs="+", default=[1024, 4096])
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=11)
    parser.add_argument("--steps", type=int, default=20)
    options = parser.parse_args()
    ratios = [ratio(envs, options.threads, options.rounds, options.steps) for envs in options.envs]
    return 0 if min(ratios) >= LEAST else 1


if __name__ == "__main__":
    sys.exit(main())
