# SPDX-License-Identifier: BSD-3-Clause
"""Policies as ONNX files, out and in. Needs the package onnx (Debian: python3-onnx)."""

import os
from typing import Any

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from . import _check
from .policies import read_policy
from .onnx_reader import HIDDEN as _HIDDEN, INPUTS as _INPUTS, TO_ONNX, gates, read_onnx
from .weights import NETWORK

_OPSET = 13


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
        graph.constant(f"encoder.{to}", gates(tensors[f"encoder.{name}"], TO_ONNX)[None])
        for to, name in (("W", "weight_ih"), ("R", "weight_hh"))
    ]
    biases = [gates(tensors[f"encoder.{name}"], TO_ONNX) for name in ("bias_ih", "bias_hh")]
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
    if not set(NETWORK) <= set(tensors) or tensors["actor.0.weight"].shape[1] != 75:
        raise ValueError(f"{policy}: found another wiring, expected encoder lstm, actor encoding, estimate")
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


def import_onnx(path: str | os.PathLike[str]) -> dict[str, np.ndarray]:
    """The weights of an ONNX file with the layers of a policy file (policy/README.md), by the file's names, for
    `write_policy`. An LSTM and six dense layers (Gemm, or MatMul and Add) are recognised by their shapes, and all
    that lies between them is checked. Of a file of `export_onnx`, the normalisation comes along, and `write_policy`
    compares it with the environment's. Raises ValueError, one line, for another network."""
    return read_onnx(_check.path("path", path))
