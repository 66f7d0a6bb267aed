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

_HIDDEN, _INPUTS = 64, 30
_LSTM = ("weight_ih", "weight_hh", "bias_ih", "bias_hh")
# All layers differ in shape, by which those of an ONNX file are recognised: (outputs, inputs).
_DENSE = {
    "estimator.0": (128, 64),
    "estimator.1": (128, 128),
    "estimator.2": (8, 128),
    "actor.0": (256, 75),
    "actor.1": (128, 256),
    "actor.2": (12, 128),
}
# Functions between layers that a policy file does not have; their layers have the same shapes.
_OTHER_ACTIVATIONS = ("Celu", "Elu", "Gelu", "Mish", "PRelu", "Relu", "Selu", "Sigmoid", "Softplus", "Tanh")
NETWORK = [f"encoder.{name}" for name in _LSTM] + [f"{layer}.{kind}" for layer in _DENSE for kind in ("weight", "bias")]
SCALES = [f"{of}.{what}" for of in ("observation", "estimate") for what in ("mean", "variance")]


def torch_names() -> dict[str, str]:
    """Names of the file by those of nn.LSTM and of nn.Sequential with an activation after each layer."""
    names = {f"encoder.{name}_l0": f"encoder.{name}" for name in _LSTM}
    for layer in _DENSE:
        part, number = layer.split(".")
        for kind in ("weight", "bias"):
            names[f"{part}.{2 * int(number)}.{kind}"] = f"{layer}.{kind}"
    return names


def gates(matrix: np.ndarray, order: tuple[int, ...]) -> np.ndarray:
    """The blocks of the four gates in another order."""
    return np.concatenate([np.split(matrix, 4)[i] for i in order])


# PyTorch and policy files: input, forget, cell, output. ONNX: input, output, forget, cell.
TO_ONNX, _FROM_ONNX = (0, 3, 1, 2), (0, 2, 3, 1)


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
            values = np.frombuffer(data[first:last], {"F32": "<f4", "F64": "<f8"}[entry["dtype"]])
            tensors[key] = values.reshape(entry["shape"])
        return tensors
    except (OSError, ValueError, KeyError, TypeError, AttributeError, OverflowError, struct.error) as error:
        raise ValueError(f"{name}: found no safetensors of F32 or F64: {error or type(error).__name__}") from None


def _attribute(node: Any, name: str, default: Any) -> Any:
    from onnx import helper

    found = [helper.get_attribute_value(a) for a in node.attribute if a.name == name]
    return found[0] if found else default


def _dense_layers(graph: Any, constants: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    found: dict[str, np.ndarray] = {}
    users = {name: node for node in graph.node for name in node.input}
    for node in graph.node:
        slope = _attribute(node, "alpha", 0.01) if node.op_type == "LeakyRelu" else 0.01
        if node.op_type in _OTHER_ACTIVATIONS or abs(slope - 0.01) > 1e-6:
            found_kind = node.op_type if node.op_type != "LeakyRelu" else f"LeakyRelu of {slope:g}"
            raise ValueError(f"activation: found {found_kind}, expected LeakyRelu of 0.01")
        weight = constants.get(node.input[1]) if node.op_type in ("Gemm", "MatMul") and len(node.input) > 1 else None
        if weight is None:
            continue
        if node.op_type == "MatMul" or not _attribute(node, "transB", 0):
            weight = weight.T
        bias_name = node.input[2] if node.op_type == "Gemm" and len(node.input) > 2 else ""
        if node.op_type == "MatMul" and (add := users.get(node.output[0])) is not None and add.op_type == "Add":
            bias_name = next((name for name in add.input if name in constants), "")
        for layer, shape in _DENSE.items():
            if weight.shape == shape:
                if f"{layer}.weight" in found:
                    raise ValueError(f"{layer}: found two layers of shape {list(shape)}, expected one")
                found[f"{layer}.weight"] = weight
                found[f"{layer}.bias"] = constants.get(bias_name, np.zeros(shape[0], np.float32)).reshape(-1)
    return found


def _lstm(graph: Any, constants: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    nodes = [node for node in graph.node if node.op_type == "LSTM"]
    if len(nodes) != 1:
        raise ValueError(f"encoder: found {len(nodes)} LSTM nodes, expected one")
    node = nodes[0]
    if _attribute(node, "direction", b"forward") != b"forward" or _attribute(node, "activations", None):
        raise ValueError("encoder: found another kind of LSTM, expected one forward with its usual activations")
    weights = [constants.get(name) for name in node.input[1:4]]
    sizes = [(1, 4 * _HIDDEN, _INPUTS), (1, 4 * _HIDDEN, _HIDDEN), (1, 8 * _HIDDEN)]
    if len(weights) == 2:
        weights.append(np.zeros(sizes[2], np.float32))
    for weight, size in zip(weights, sizes, strict=True):
        if weight is None or weight.shape != size:
            shape = "none" if weight is None else list(weight.shape)
            raise ValueError(f"encoder: found weights of shape {shape}, expected {list(size)}")
    bias_ih, bias_hh = np.split(weights[2][0], 2)
    parts = {"weight_ih": weights[0][0], "weight_hh": weights[1][0], "bias_ih": bias_ih, "bias_hh": bias_hh}
    return {f"encoder.{name}": gates(part, _FROM_ONNX) for name, part in parts.items()}


def read_onnx(name: str) -> dict[str, np.ndarray]:
    """An LSTM and six dense layers (Gemm, or MatMul and Add) are recognised by their shapes. Of a file of `export_onnx`,
    the scales come along."""
    try:
        import onnx
        from onnx import numpy_helper
    except ImportError:
        raise ValueError(f"{name}: needs the Python package onnx (Debian: python3-onnx)") from None
    try:
        model = onnx.load(name)
    except Exception as error:  # of protobuf, whose classes differ from version to version
        raise ValueError(f"{name}: found no ONNX file: {str(error).splitlines()[0] if str(error) else error!r}") from None
    constants = {tensor.name: numpy_helper.to_array(tensor) for tensor in model.graph.initializer}
    for node in model.graph.node:
        if node.op_type == "Constant" and (value := _attribute(node, "value", None)) is not None:
            constants[node.output[0]] = numpy_helper.to_array(value)
    tensors = {**_lstm(model.graph, constants), **_dense_layers(model.graph, constants)}
    for layer, shape in _DENSE.items():
        if f"{layer}.weight" not in tensors:
            raise ValueError(f"{name}: found no dense layer of shape {list(shape)}, expected '{layer}'")
    if model.producer_name == "sandrunner":
        for of, floor in (("observation", 1e-8), ("estimate", 0.0)):
            tensors[f"{of}.mean"] = constants[f"{of}.mean"]
            tensors[f"{of}.variance"] = constants[f"{of}.deviation"].astype(np.float64) ** 2 - floor
    return {key: np.ascontiguousarray(value, np.float32) for key, value in tensors.items()}


def read_weights(path: str | os.PathLike[str], theirs: Mapping[str, str] | None = None) -> dict[str, np.ndarray]:
    """All tensors of the network and its scales that a file has: an npz, or ONNX or safetensors by the name's end.
    They have PyTorch's names, those of a policy file, or what `theirs` calls the latter. Other tensors are left out."""
    name = os.fspath(path)
    read = {".onnx": read_onnx, ".safetensors": _safetensors}.get(os.path.splitext(name)[1], _npz)
    available = read(name)
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
