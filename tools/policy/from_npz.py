#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a policy file from a PyTorch state_dict saved as npz. Needs numpy only.

In PyTorch:
    np.savez("policy.npz", **{k: v.cpu().numpy() for k, v in model.state_dict().items()})
Then:
    python3 from_npz.py policy.npz --out policy.safetensors --name mine [--map map.txt] [--set key=value ...]

Tensors that the file needs (README.md in the folder policy/ gives shapes): encoder.weight_ih, encoder.weight_hh,
encoder.bias_ih, encoder.bias_hh (an nn.LSTM's weight_ih_l0, ...: gate order i, f, g, o), estimator.{0,1,2}.{weight,bias},
actor.{0,1,2}.{weight,bias}, observation.mean, observation.variance, estimate.mean, estimate.variance. Other names in the
npz are translated by --map, a text file with a line "ours theirs" for each. --set changes metadata, for instance
--set action_scale_rad=0.25. The golden example is computed here in double precision; the robot re-runs it at every load.
"""
import argparse
import json
import math
import os
import re
import struct
import sys
import zipfile
import zlib

try:
    import numpy as np
except ImportError:
    print("from_npz.py: needs numpy (Debian: python3-numpy)", file=sys.stderr)
    sys.exit(2)

SHAPES = {
    "encoder.weight_ih": (256, 30), "encoder.weight_hh": (256, 64),
    "encoder.bias_ih": (256,), "encoder.bias_hh": (256,),
    "estimator.0.weight": (128, 64), "estimator.0.bias": (128,),
    "estimator.1.weight": (128, 128), "estimator.1.bias": (128,),
    "estimator.2.weight": (8, 128), "estimator.2.bias": (8,),
    "actor.0.weight": (256, 75), "actor.0.bias": (256,),
    "actor.1.weight": (128, 256), "actor.1.bias": (128,),
    "actor.2.weight": (12, 128), "actor.2.bias": (12,),
    "observation.mean": (33,), "observation.variance": (33,),
    "estimate.mean": (8,), "estimate.variance": (8,),
}
LEG = ["0.0", "0.559836", "-1.119672"]
METADATA = {
    "format": "1",
    "joint_names": ",".join(f"{leg}_{joint}" for leg in ("LF", "RF", "LH", "RH") for joint in ("HAA", "HFE", "KFE")),
    "policy_hz": "100",
    "control_hz": "4000",
    "nominal_position_rad": ",".join(LEG * 4),
    "action_scale_rad": "0.3",
    "action_clip": "0",
    "kp_nmprad": "50",
    "kd_nmsprad": "0.5",
    "torque_limit_nm": "63.45",
    "yaw_command_clip_mps2": "2.943",
    "observation_clip": "10",
}
# Metadata that is a number, and whether 0 is refused.
NUMBERS = {
    "action_scale_rad": True, "action_clip": False, "kp_nmprad": False, "kd_nmsprad": False, "torque_limit_nm": True,
    "yaw_command_clip_mps2": True, "observation_clip": True,
}
GOLDEN_STEPS = 50


def fail(message):
    print(f"from_npz.py: {message}", file=sys.stderr)
    sys.exit(2)


def usable(text, above_zero):
    if not re.fullmatch(r"(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", text):
        return False
    return math.isfinite(float(text)) and (float(text) > 0 or not above_zero)


def read_tensors(path, map_path):
    try:
        archive = np.load(path, allow_pickle=False)
        available = {name: archive[name] for name in archive.files}
    except (OSError, ValueError, AttributeError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        fail(f"{path}: not an npz of arrays: {(str(error).splitlines() or [type(error).__name__])[0]}")
    names = {}
    if map_path:
        try:
            lines = open(map_path, encoding="utf-8").read().splitlines()
        except OSError as error:
            fail(f"{map_path}: {error.strerror}")
        except UnicodeDecodeError:
            fail(f"{map_path}: not a text file (UTF-8)")
        for number, line in enumerate(lines, 1):
            words = line.split()
            if not words:
                continue
            if len(words) != 2 or words[0] not in SHAPES:
                fail(f"{map_path}:{number}: '{line}', expected 'ours theirs' with one of our names first")
            names[words[0]] = words[1]
    tensors = {}
    for name, shape in SHAPES.items():
        theirs = names.get(name, name)
        if theirs not in available:
            fail(f"{path}: has no tensor '{theirs}'")
        try:
            tensor = np.asarray(available[theirs], dtype=np.float32)
        except (ValueError, TypeError):
            fail(f"{path}: tensor '{theirs}' is not of numbers")
        if tensor.shape != shape:
            fail(f"{path}: tensor '{theirs}' has shape {list(tensor.shape)}, expected {list(shape)}")
        if not np.isfinite(tensor).all():
            fail(f"{path}: tensor '{theirs}' holds a value that is not finite")
        if name.endswith(".variance") and (tensor < 0).any():
            fail(f"{path}: tensor '{theirs}' holds a variance below 0")
        tensors[name] = tensor
    return tensors


def mlp(t, name, x):
    for layer in range(3):
        x = t[f"{name}.{layer}.weight"] @ x + t[f"{name}.{layer}.bias"]
        if layer < 2:
            x = np.where(x > 0, x, 0.01 * x)
    return x


def golden_example(tensors, clip):
    """50 chained steps from the zero state, in double precision; observations spread like the training data."""
    t = {name: value.astype(np.float64) for name, value in tensors.items()}
    mean, deviation = t["observation.mean"], np.sqrt(t["observation.variance"] + 1e-8)
    h, c = np.zeros(64), np.zeros(64)
    rows = {"golden.observation": [], "golden.action": [], "golden.estimate": []}
    for k in range(GOLDEN_STEPS):
        phase = 0.37 * k + 0.61 * np.arange(33)
        # A few reach far out, so that the limit is exercised too.
        spread = np.where(np.arange(33) == k % 33, 1.5 * clip, 1.2)
        observation = (mean + spread * np.sin(phase) * deviation).astype(np.float32)
        x = np.clip((observation.astype(np.float64) - mean) / deviation, -clip, clip)
        gates = (t["encoder.weight_ih"] @ x[3:] + t["encoder.bias_ih"] + t["encoder.weight_hh"] @ h + t["encoder.bias_hh"])
        i, f, g, o = np.split(gates, 4)
        c = c / (1 + np.exp(-f)) + np.tanh(g) / (1 + np.exp(-i))
        h = np.tanh(c) / (1 + np.exp(-o))
        estimate = mlp(t, "estimator", h)
        action = mlp(t, "actor", np.concatenate([x[:3], h, estimate]))
        for name, value in zip(rows, (observation, action, estimate)):
            rows[name].append(value)
    return {name: np.asarray(value, dtype=np.float32) for name, value in rows.items()}


def write(path, tensors, metadata):
    header, offset = {"__metadata__": metadata}, 0
    for name in sorted(tensors):
        size = tensors[name].nbytes
        header[name] = {"dtype": "F32", "shape": list(tensors[name].shape), "data_offsets": [offset, offset + size]}
        offset += size
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    temporary = f"{path}.part"
    try:
        with open(temporary, "wb") as out:
            out.write(struct.pack("<Q", len(text)) + text)
            for name in sorted(tensors):
                out.write(np.ascontiguousarray(tensors[name], dtype="<f4").tobytes())
            out.flush()
            os.fsync(out.fileno())
        os.replace(temporary, path)
    except OSError as error:
        if os.path.exists(temporary):
            os.remove(temporary)
        fail(f"{path}: cannot be written: {error.strerror}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("npz")
    parser.add_argument("--out", required=True)
    parser.add_argument("--name", default="imported")
    parser.add_argument("--map")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    arguments = parser.parse_args()
    metadata = dict(METADATA)
    provenance = {"origin": "from_npz.py", "source": os.path.basename(arguments.npz)}
    for assignment in arguments.set:
        key, equals, value = assignment.partition("=")
        if not equals or key not in METADATA:
            fail(f"--set {assignment}: expected one of {', '.join(METADATA)} and a value")
        if key in NUMBERS and not usable(value, NUMBERS[key]):
            fail(f"--set {assignment}: expected a number {'>' if NUMBERS[key] else '>='} 0")
        metadata[key] = value
    clip = float(metadata["observation_clip"])
    tensors = read_tensors(arguments.npz, arguments.map)
    tensors.update(golden_example(tensors, clip))
    all_metadata = {f"sandrunner.{key}": value for key, value in metadata.items()}
    all_metadata["sandrunner.name"] = arguments.name
    all_metadata.update({f"provenance.{key}": value for key, value in provenance.items()})
    write(arguments.out, tensors, all_metadata)
    print(f"wrote {arguments.out}")


if __name__ == "__main__":
    main()
