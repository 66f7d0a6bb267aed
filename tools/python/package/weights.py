# SPDX-License-Identifier: BSD-3-Clause
"""Weights of networks that were trained elsewhere, by the names of a policy file (policy/README.md): from the npz of a
PyTorch state_dict, an ONNX file or a safetensors file. Needs numpy, for ONNX the package onnx (Debian: python3-onnx).
Wrong files are a ValueError of one line."""

import json
import os
import struct
import zipfile
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np

if __package__:
    from .onnx_reader import DENSE, read_onnx
else:  # of tools/policy/import_policy.py, which needs no built package
    from onnx_reader import DENSE, read_onnx

_LSTM = ("weight_ih", "weight_hh", "bias_ih", "bias_hh")
NETWORK = [f"encoder.{name}" for name in _LSTM] + [f"{layer}.{kind}" for layer in DENSE for kind in ("weight", "bias")]
SCALES = [f"{of}.{what}" for of in ("observation", "estimate") for what in ("mean", "variance")]


_DTYPES = {"F16": "<f2", "F32": "<f4", "F64": "<f8", "I32": "<i4", "I64": "<i8"}


def torch_names() -> dict[str, str]:
    """Names of the file by those of nn.LSTM and of nn.Sequential with an activation after each layer."""
    names = {f"encoder.{name}_l0": f"encoder.{name}" for name in _LSTM}
    for layer in DENSE:
        part, number = layer.split(".")
        for kind in ("weight", "bias"):
            names[f"{part}.{2 * int(number)}.{kind}"] = f"{layer}.{kind}"
    return names


def _npz(name: str) -> dict[str, np.ndarray]:
    try:
        with np.load(name, allow_pickle=False) as archive:
            return {key: archive[key] for key in archive.files}
    except (OSError, ValueError, AttributeError, EOFError, TypeError, zipfile.BadZipFile, zlib.error) as error:
        cause = (str(error).splitlines() or [type(error).__name__])[0]
        raise ValueError(f"{name}: found no npz of arrays: {cause}") from None


def _safetensors(name: str) -> dict[str, np.ndarray]:
    try:
        with open(name, "rb") as file:
            data = file.read()
        begin = 8 + struct.unpack("<Q", data[:8])[0]
        header = json.loads(data[8:begin])
        header.pop("__metadata__", None)
        tensors = {}
        for key, entry in header.items():
            first, last = (begin + offset for offset in entry["data_offsets"])
            values = np.frombuffer(data[first:last], _DTYPES[entry["dtype"]])
            tensors[key] = values.reshape(entry["shape"])
        return tensors
    except (OSError, ValueError, KeyError, TypeError, AttributeError, OverflowError, struct.error) as error:
        raise ValueError(f"{name}: found no safetensors of numbers: {error or type(error).__name__}") from None


def read_tensors(name: str) -> dict[str, np.ndarray]:
    """All tensors of an npz or of a safetensors file."""
    return _safetensors(name) if name.endswith(".safetensors") else _npz(name)


def read_weights(path: str | os.PathLike[str], theirs: Mapping[str, str] | None = None) -> dict[str, np.ndarray]:
    """All tensors of the network and its scales that a file has: an npz, or ONNX or safetensors by the name's end.
    They have PyTorch's names, those of a policy file, or what `theirs` calls the latter. Other tensors are left out."""
    name = os.fspath(path)
    available = read_onnx(name) if name.endswith(".onnx") else read_tensors(name)
    names = {ours: torch for torch, ours in torch_names().items()} if "actor.4.weight" in available else {}
    # An LSTM's names do not depend on those of the layers behind it.
    names |= {f"encoder.{part}": f"encoder.{part}_l0" for part in _LSTM if f"encoder.{part}_l0" in available}
    names |= theirs or {}
    tensors = {}
    for ours in NETWORK + SCALES:
        their = names.get(ours, ours)
        if their not in available:
            continue
        try:
            tensors[ours] = np.ascontiguousarray(available[their], np.float32)
        except (ValueError, TypeError):
            raise ValueError(f"{name}: tensor '{their}' is not of numbers") from None
    return tensors


def read_names(path: str) -> dict[str, str]:
    """Their names by ours, of a text file with a line "ours theirs" for each."""
    try:
        with open(path, encoding="utf-8") as file:
            lines = file.read().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: found no text file (UTF-8): {str(error).splitlines()[0]}") from None
    names = {}
    for number, line in enumerate(lines, 1):
        words = line.split()
        if words and (len(words) != 2 or words[0] not in NETWORK + SCALES):
            raise ValueError(f"{path}:{number}: found '{line}', expected 'ours theirs' with one of our names first")
        names |= dict([words]) if words else {}
    return names


def write_safetensors(path: str, tensors: Mapping[str, np.ndarray], metadata: Mapping[str, str]) -> None:
    """Bare weights, as `sandrunner-policy import` takes them."""
    header: dict[str, Any] = {"__metadata__": dict(metadata)}
    offset = 0
    for name, tensor in tensors.items():
        header[name] = {"dtype": "F32", "shape": tensor.shape, "data_offsets": [offset, offset + tensor.nbytes]}
        offset += tensor.nbytes
    text = json.dumps(header).encode()
    with open(path, "wb") as file:
        file.write(struct.pack("<Q", len(text)) + text)
        for tensor in tensors.values():
            file.write(tensor.tobytes())
