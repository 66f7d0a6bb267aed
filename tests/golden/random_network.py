#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes random_network.safetensors and random_network.csv next to this script. Needs numpy (Debian: python3-numpy).

A network of random weights in the layout of policy/README.md without golden example and metadata, and 50 consecutive
steps of it from zero memory, computed in double precision from the formulas there (paper, "Controller structure") by
code that shares nothing with the project's. A row: number of the step, raw observation (33), output of the LSTM (64),
estimate before scaling (8), estimate in physical units (8), action before scaling (12).
"""
import argparse
import json
import pathlib
import struct

import numpy as np

argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()

STEPS = 50
FOLDER = pathlib.Path(__file__).parent
random = np.random.RandomState(2023)  # its stream is the same in every version of numpy


def drawn(shape, scale):
    """Multiples of scale / 16 in +-scale: exact in float32, and a file that compresses well."""
    return random.randint(-16, 17, shape) * (scale / 16.0)


def layer(name, outputs, inputs):
    # 2 / sqrt(inputs), to the nearest power of two: keeps outputs near 1.
    scale = 2.0 ** round(np.log2(2.0 / np.sqrt(inputs)))
    return {f"{name}.weight": drawn((outputs, inputs), scale), f"{name}.bias": drawn((outputs,), scale)}


w = {
    "observation.mean": drawn((33,), 1.0),
    "observation.variance": 1.25 + drawn((33,), 1.0),
    "encoder.weight_ih": drawn((256, 30), 0.125),
    "encoder.weight_hh": drawn((256, 64), 0.25),
    "encoder.bias_ih": drawn((256,), 0.5),
    "encoder.bias_hh": drawn((256,), 0.25),
    **layer("estimator.0", 128, 64), **layer("estimator.1", 128, 128), **layer("estimator.2", 8, 128),
    **layer("actor.0", 256, 75), **layer("actor.1", 128, 256), **layer("actor.2", 12, 128),
    "estimate.mean": drawn((8,), 1.0),
    "estimate.variance": 1.25 + drawn((8,), 1.0),
}


def sigmoid(x):
    return 1.0 / (1.0 + np.exp(-x))


def mlp(name, x):
    for i in range(3):
        x = w[f"{name}.{i}.weight"] @ x + w[f"{name}.{i}.bias"]
        if i < 2:
            x = np.where(x > 0.0, x, 0.01 * x)
    return x


def run():
    h, c = np.zeros(64), np.zeros(64)
    for k in range(STEPS):
        # Some of the normalised values lie beyond the clip, +-10.
        observation = drawn((33,), 8.0) * np.where(random.randint(0, 12, 33) == 0, 4.0, 1.0)
        x = np.clip((observation - w["observation.mean"]) / np.sqrt(w["observation.variance"] + 1e-8), -10.0, 10.0)
        gates = (w["encoder.weight_ih"] @ x[3:] + w["encoder.bias_ih"] + w["encoder.weight_hh"] @ h + w["encoder.bias_hh"])
        i, f, g, o = gates.reshape(4, 64)
        c = sigmoid(f) * c + sigmoid(i) * np.tanh(g)
        h = sigmoid(o) * np.tanh(c)
        estimate = mlp("estimator", h)
        action = mlp("actor", np.concatenate([x[:3], h, estimate]))
        yield [k, *observation, *h, *estimate, *(estimate * np.sqrt(w["estimate.variance"]) + w["estimate.mean"]), *action]


header, data = {}, b""
for name, values in w.items():
    block = values.astype("<f4").tobytes()
    header[name] = {"dtype": "F32", "shape": list(values.shape), "data_offsets": [len(data), len(data) + len(block)]}
    data += block
text = json.dumps(header).encode()
text += b" " * (-len(text) % 8)
(FOLDER / "random_network.safetensors").write_bytes(struct.pack("<Q", len(text)) + text + data)

columns = ["k"] + [f"{name}{i}" for name, size in
                   [("obs", 33), ("h", 64), ("est_raw", 8), ("est", 8), ("act", 12)] for i in range(size)]
rows = [",".join(f"{value:.9g}" for value in row) for row in run()]
(FOLDER / "random_network.csv").write_text("\n".join([",".join(columns), *rows]) + "\n")
