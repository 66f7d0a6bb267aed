#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a policy file from weights that were trained elsewhere: the npz of a PyTorch state_dict, ONNX or safetensors.

In PyTorch:
    np.savez("policy.npz", **{k: v.cpu().numpy() for k, v in model.state_dict().items()})
Then:
    python3 import_policy.py policy.npz --out policy.safetensors --robot go2 --set action_scale_rad=0.25

policy/README.md has the names and shapes of the tensors; PyTorch's own names are known, and --map translates others: a
text file with a line "ours theirs" for each. All other options are those of 'sandrunner-policy import', which writes
the file. Needs numpy, for ONNX the package onnx."""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/python/package"))
try:
    import foreign
    import weights
except ImportError:
    print("import_policy.py: needs numpy (Debian: python3-numpy)", file=sys.stderr)
    sys.exit(2)


def activation_in(description):
    """What a description says between the layers; whether it is good otherwise, the program judges."""
    shipped = ROOT / f"tools/policy/descriptions/{description}.toml"
    path = shipped if shipped.exists() else pathlib.Path(description)
    try:
        found = tomllib.loads(path.read_text(encoding="utf-8")).get("activation", "elu")
    except (OSError, ValueError) as error:
        raise ValueError(f"{description}: found no description: {error}") from None
    if not isinstance(found, str) or found not in foreign.ACTIVATIONS:
        raise ValueError(f"{description}: activation: found {found!r}, expected one of {', '.join(foreign.ACTIVATIONS)}")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], allow_abbrev=False)
    parser.add_argument("weights", help="FILE.npz, FILE.onnx or FILE.safetensors")
    parser.add_argument("--map", metavar="FILE", help="lines 'ours theirs': names of tensors")
    parser.add_argument("--observation", metavar="NAME", help="description of a network of others, or its file")
    parser.add_argument("--program", default=ROOT / "build/release/bin/sandrunner-policy", help="default: %(default)s")
    arguments, options = parser.parse_known_args()
    name = os.path.basename(arguments.weights)
    with tempfile.TemporaryDirectory() as folder:
        bare = os.path.join(folder, name)
        try:
            if arguments.observation:
                tensors, metadata = foreign.read_perceptron(arguments.weights, activation_in(arguments.observation))
                options += ["--observation", arguments.observation]
            else:
                names = weights.read_names(arguments.map) if arguments.map else {}
                tensors, metadata = weights.read_weights(arguments.weights, names), {}
            weights.write_safetensors(bare, tensors, {"origin": "import_policy.py"} | metadata)
            return subprocess.run([arguments.program, "import", bare, *options]).returncode
        except (ValueError, OSError) as error:
            print(f"import_policy.py: {error}", file=sys.stderr)
            return 2


if __name__ == "__main__":
    sys.exit(main())
