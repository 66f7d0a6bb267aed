# SPDX-License-Identifier: BSD-3-Clause
"""Policies as ONNX files, out and in. Needs the package onnx (Debian: python3-onnx)."""

import os
from typing import Any

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from . import _check
from .policies import read_policy

_OPSET = 13
# All layers differ in shape, by which those of a foreign file are recognised: (outputs, inputs).
_DENSE = {
    "estimator.0": (128, 64),
    "estimator.1": (128, 128),
    "estimator.2": (8, 128),
    "actor.0": (256, 75),
    "actor.1": (128, 256),
    "actor.2": (12, 128),
}
_HIDDEN, _INPUTS = 64, 30


def _gates(matrix: np.ndarray, order: tuple[int, ...]) -> np.ndarray:
    """The blocks of the four gates in another order."""
    return np.concatenate([np.split(matrix, 4)[i] for i in order])


# PyTorch and policy files: input, forget, cell, output. ONNX: input, output, forget, cell.
_TO_ONNX, _FROM_ONNX = (0, 3, 1, 2), (0, 2, 3, 1)


class _Graph:
    def __init__(self) -> None:
        self.nodes: list[Any] = []
        self.initializers: list[Any] = []

    def constant(self, name: str, values: Any, dtype: Any = np.float32) -> str:
        self.initializers.append(numpy_helper.from_array(np.asarray(values, dtype), name))
        return name

    def add(self, kind: str, inputs: list[str], outputs: list[str], **attributes: Any) -> str:
        self.nodes.append(helper.make_node(kind, inputs, outputs, **attributes))
        return outputs[0]

    def limit(self, x: str, limit: float, to: str) -> str:
        low, high = self.constant(f"{to}.low", -limit), self.constant(f"{to}.high", limit)
        return self.add("Clip", [x, low, high], [to])

    def mlp(self, part: str, x: str, tensors: dict[str, np.ndarray], to: str) -> str:
        for layer in range(3):
            weight = self.constant(f"{part}.{layer}.weight", tensors[f"{part}.{layer}.weight"])
            bias = self.constant(f"{part}.{layer}.bias", tensors[f"{part}.{layer}.bias"])
            last = layer == 2
            x = self.add("Gemm", [x, weight, bias], [to if last else f"{part}.{layer}.sum"], transB=1)
            if not last:
                x = self.add("LeakyRelu", [x], [f"{part}.{layer}.out"], alpha=0.01)
        return x


def _encoder(graph: _Graph, x: str, tensors: dict[str, np.ndarray]) -> str:
    weights = [
        graph.constant(f"encoder.{to}", _gates(tensors[f"encoder.{name}"], _TO_ONNX)[None])
        for to, name in (("W", "weight_ih"), ("R", "weight_hh"))
    ]
    biases = [_gates(tensors[f"encoder.{name}"], _TO_ONNX) for name in ("bias_ih", "bias_hh")]
    weights.append(graph.constant("encoder.B", np.concatenate(biases)[None]))
    first = graph.constant("first_axis", [0], np.int64)
    sequence = graph.add("Unsqueeze", [x, first], ["encoder.sequence"])
    graph.add("LSTM", [sequence, *weights, "", "h", "c"], ["", "h_out", "c_out"], hidden_size=_HIDDEN)
    return graph.add("Squeeze", ["h_out", first], ["encoding"])


def export_onnx(policy: str | os.PathLike[str], path: str | os.PathLike[str]) -> None:
    """Writes a policy file as ONNX. Inputs: observation (robots, 33), raw as estimator/observation.h builds it, and
    the memory h, c (1, robots, 64), zero at the start. Outputs: joint_target (robots, 12), rad; estimate
    (robots, 8), in physical units; h_out, c_out, the next step's h, c. Gains and names are in its metadata."""
    tensors, spec = read_policy(policy)
    graph = _Graph()
    mean = graph.constant("observation.mean", tensors["observation.mean"])
    deviation = np.sqrt(tensors["observation.variance"].astype(np.float64) + 1e-8)
    centred = graph.add("Sub", ["observation", mean], ["observation.centred"])
    scaled = graph.add("Div", [centred, graph.constant("observation.deviation", deviation)], ["observation.scaled"])
    shown = graph.limit(scaled, spec["observation_clip"], "observation.shown")
    sizes = graph.constant("observation.sizes", [3, _INPUTS], np.int64)
    graph.add("Split", [shown, sizes], ["command", "proprioception"], axis=1)
    encoding = _encoder(graph, "proprioception", tensors)
    raw = graph.mlp("estimator", encoding, tensors, "estimate.raw")
    everything = graph.add("Concat", ["command", encoding, raw], ["actor.in"], axis=1)
    action = graph.mlp("actor", everything, tensors, "action")
    if spec["action_clip"] > 0.0:
        action = graph.limit(action, spec["action_clip"], "action.limited")
    scaled = graph.add("Mul", [action, graph.constant("action.scale", spec["action_scale_rad"])], ["action.scaled"])
    nominal = graph.constant("nominal_position", spec["nominal_position_rad"])
    graph.add("Add", [scaled, nominal], ["joint_target"])
    spread = graph.constant("estimate.deviation", np.sqrt(spec["estimate_variance"]))
    spread_out = graph.add("Mul", [raw, spread], ["estimate.scaled"])
    graph.add("Add", [spread_out, graph.constant("estimate.mean", spec["estimate_mean"])], ["estimate"])

    def value(name: str, *shape: Any) -> Any:
        return helper.make_tensor_value_info(name, TensorProto.FLOAT, shape)

    memory = (1, "robots", _HIDDEN)
    model = helper.make_model(
        helper.make_graph(
            graph.nodes,
            "policy",
            [value("observation", "robots", 33), value("h", *memory), value("c", *memory)],
            [value("joint_target", "robots", 12), value("estimate", "robots", 8)]
            + [value("h_out", *memory), value("c_out", *memory)],
            graph.initializers,
        ),
        opset_imports=[helper.make_opsetid("", _OPSET)],
        producer_name="sandrunner",
        ir_version=8,
    )
    keys = ("name", "joint_names", "kp_nmprad", "kd_nmsprad", "torque_limit_nm", "yaw_command_clip_mps2")
    text = {key: ",".join(spec[key]) if key == "joint_names" else str(spec[key]) for key in keys}
    helper.set_model_props(model, {f"sandrunner.{key}": value for key, value in text.items()})
    onnx.checker.check_model(model)
    with open(_check.path("path", path), "wb") as out:
        out.write(model.SerializeToString())


def _attribute(node: Any, name: str, default: Any) -> Any:
    found = [helper.get_attribute_value(a) for a in node.attribute if a.name == name]
    return found[0] if found else default


def _dense_layers(graph: Any, constants: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    found: dict[str, np.ndarray] = {}
    users = {name: node for node in graph.node for name in node.input}
    for node in graph.node:
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
    return {f"encoder.{name}": _gates(part, _FROM_ONNX) for name, part in parts.items()}


def import_onnx(path: str | os.PathLike[str]) -> dict[str, np.ndarray]:
    """The weights of an ONNX file with the layers of a policy file (policy/README.md), by the file's names, for
    `write_policy`. An LSTM and six dense layers (Gemm, or MatMul and Add) are recognised by their shapes. Of a file
    of `export_onnx`, the normalisation comes along, and `write_policy` compares it with the environment's."""
    name = _check.path("path", path)
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
        tensors["observation.mean"] = constants["observation.mean"]
        tensors["observation.variance"] = (constants["observation.deviation"].astype(np.float64) ** 2 - 1e-8).astype(
            np.float32
        )
    return {key: np.ascontiguousarray(value, np.float32) for key, value in tensors.items()}
