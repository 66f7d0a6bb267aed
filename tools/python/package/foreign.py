# SPDX-License-Identifier: BSD-3-Clause
"""Perceptrons that others trained, as `sandrunner-policy import --observation` takes them: layers counted from 0, with
a golden example that is computed here from their file, not from what was imported. Reads an npz or safetensors of a
PyTorch state_dict (rsl_rl, legged_gym, HIMLoco) and ONNX. Wrong files are a ValueError of one line."""

import os
import re
from typing import Any

import numpy as np

if __package__:
    from .onnx_reader import attributes_of, load_graph, named
    from .weights import read_tensors
else:  # of tools/policy/import_policy.py, which needs no built package
    from onnx_reader import attributes_of, load_graph, named
    from weights import read_tensors

GOLDEN_STEPS = 50
# The last name of a layer's place in a state_dict counts the activations, too.
_LAYER = re.compile(r"(?:(?:module|actor_critic|policy)\.)?(actor|estimator|estimator\.encoder)\.(?:\w+\.)?(\d+)\.(weight|bias)")
_NORMALISER = re.compile(r"(?:actor_obs|obs)_normalizer\.(_mean|_std|_var|count)|actor\.obs_normalizer\.(_mean|_std|_var|count)")
_UNUSED = re.compile(r"(critic|std|log_std|estimator\.(target|proto)|critic_obs_normalizer)\b.*")
ACTIVATIONS = {
    "elu": lambda x: np.where(x > 0, x, np.expm1(np.minimum(x, 0.0))),
    "relu": lambda x: np.maximum(x, 0.0),
    "leaky_relu": lambda x: np.where(x > 0, x, 0.01 * x),
    "tanh": np.tanh,
}
_OF_ONNX = {"Elu": "elu", "Relu": "relu", "LeakyRelu": "leaky_relu", "Tanh": "tanh"}
Layers = list[tuple[np.ndarray, np.ndarray]]  # (weight, bias), double


def _run(layers: Layers, activation: str, x: np.ndarray) -> np.ndarray:
    for number, (weight, bias) in enumerate(layers):
        x = x @ weight.T + bias
        if number + 1 < len(layers):
            x = ACTIVATIONS[activation](x)
    return x


def _answers(estimator: Layers, actor: Layers, activation: str, x: np.ndarray) -> np.ndarray:
    """An estimator's first three outputs are a velocity, the rest a latent of length 1 (HIMLoco)."""
    if estimator:
        out = _run(estimator, activation, x)
        latent = out[:, 3:] / np.maximum(np.linalg.norm(out[:, 3:], axis=1, keepdims=True), 1e-12)
        x = np.concatenate([x[:, : actor[0][0].shape[1] - out.shape[1]], out[:, :3], latent], axis=1)
    return _run(actor, activation, x)


def _folded(layers: Layers, mean: np.ndarray, deviation: np.ndarray) -> Layers:
    """A normaliser within the first layer."""
    weight, bias = layers[0]
    return [(weight / deviation, bias - weight @ (mean / deviation)), *layers[1:]]


def _stack(name: str, part: str, numbered: dict[int, dict[str, np.ndarray]]) -> Layers:
    layers: Layers = []
    for number in sorted(numbered):
        weight = np.atleast_1d(numbered[number].get("weight", np.zeros(0)))
        bias = numbered[number].get("bias", np.zeros(weight.shape[0]))
        inputs = layers[-1][0].shape[0] if layers else weight.shape[-1]
        if weight.ndim != 2 or weight.shape[1] != inputs or bias.shape != weight.shape[:1]:
            raise ValueError(f"{name}: {part}.{number}: found weight {list(weight.shape)} and bias {list(bias.shape)}, "
                             f"expected [outputs, {inputs}] and [outputs]")
        layers.append((weight, bias))
    return layers


def _from_state_dict(name: str, found: dict[str, np.ndarray]) -> tuple[Layers, Layers, dict[str, np.ndarray]]:
    """(estimator, actor, what is left: the golden example)."""
    parts: dict[str, dict[int, dict[str, np.ndarray]]] = {"actor": {}, "estimator": {}}
    normaliser, rest = {}, {}
    for key, value in found.items():
        if not isinstance(key, str) or getattr(value, "dtype", np.dtype(object)).kind not in "fiu":
            raise ValueError(f"{name}: tensor {key!r} is not of numbers by a name")
        if _UNUSED.fullmatch(key):
            continue
        if match := _LAYER.fullmatch(key):
            layer = parts[match[1].split(".")[0]].setdefault(int(match[2]), {})
            if match[3] in layer:
                raise ValueError(f"{name}: found two tensors for {match[1]}.{match[2]}.{match[3]}, one is '{key}'")
            layer[match[3]] = value.astype(np.float64)
        elif match := _NORMALISER.fullmatch(key):
            normaliser[match[1] or match[2]] = value.astype(np.float64).reshape(-1)
        elif key in ("golden_observation", "golden_action"):
            rest[key] = value.astype(np.float32)
        else:
            raise ValueError(f"{name}: found tensor '{key}', expected layers of an actor and at most an estimator, such as "
                             "actor.0.weight: another network")
    actor, estimator = (_stack(name, part, numbered) for part, numbered in parts.items())
    if not actor:
        raise ValueError(f"{name}: found no tensor 'actor.0.weight', expected the layers of an actor")
    if normaliser:
        if estimator:
            raise ValueError(f"{name}: found a normaliser and an estimator, expected one of them")
        if not {"_mean", "_std"} <= normaliser.keys():
            raise ValueError(f"{name}: found a normaliser without _mean and _std")
        # rsl_rl: EmpiricalNormalization.
        actor = _folded(actor, normaliser["_mean"], normaliser["_std"] + 1e-2)
    return estimator, actor, rest


class _OnnxPerceptron:
    """A graph of dense layers in a row, taken node by node."""

    def __init__(self, name: str) -> None:
        self.name, self.graph = name, load_graph(name)
        graph = self.graph
        if len(graph.outputs) != 1:
            raise ValueError(f"{name}: found {len(graph.outputs)} outputs, expected the actions")
        self.layers: Layers = []
        self.activation = ""
        if len(graph.inputs_in_order) != 1:
            raise ValueError(f"{name}: found {len(graph.inputs_in_order)} inputs, expected the observation")
        for node in graph.nodes:
            # FLOAT, DOUBLE.
            kept = node.op_type != "Cast" or attributes_of(node).get("to") in (1, 11)
            if node.op_type == "Transpose" or not kept or (node.op_type == "Reshape" and not self._flattens(node)):
                raise ValueError(f"{name}: {named(node)}: not understood, expected the numbers in their order")
        shift, factor, value, is_dense = 0.0, 1.0, graph.inputs_in_order[0], False
        while (users := graph.users(value)):
            if len(users) != 1:
                raise ValueError(f"{name}: {named(users[1])}: found a branch, expected layers in a row")
            node = users[0]
            constant = next((graph.constants[n].astype(np.float64) for n in node.input if n in graph.constants), None)
            if node.op_type in ("Gemm", "MatMul"):
                dense = graph.dense(node)
                weight, bias = dense.weight.astype(np.float64), dense.bias.astype(np.float64)
                if not self.layers:  # x = (input + shift) * factor
                    weight, bias = weight * factor, bias + weight @ (np.zeros(weight.shape[1]) + shift * factor)
                if is_dense:
                    raise ValueError(f"{name}: {named(node)}: found no activation before it")
                self.layers.append((weight, bias))
                value, is_dense = dense.output, True
                continue
            if not self.layers and constant is not None and node.op_type in ("Sub", "Add", "Div", "Mul"):
                constant = constant.reshape(-1)
                if node.op_type in ("Sub", "Add"):
                    shift = shift + (constant if node.op_type == "Add" else -constant) / factor
                else:
                    factor = factor * (constant if node.op_type == "Mul" else 1.0 / constant)
                if node.op_type in ("Sub", "Div") and node.input[0] in graph.constants:
                    raise ValueError(f"{name}: {named(node)}: found the input subtracted or divided by")
            elif node.op_type in _OF_ONNX and is_dense:
                self._activate(node)
                is_dense = False
            else:
                raise ValueError(f"{name}: {named(node)}: not understood, expected Gemm or MatMul with {', '.join(_OF_ONNX)} "
                                 "between them")
            value = node.output[0]
        if graph.source(graph.outputs[0]) != value or not is_dense:
            raise ValueError(f"{name}: found an output that is not the last dense layer's")

    def _flattens(self, node: Any) -> bool:
        """To rows of numbers, whose order stays."""
        shape = self.graph.constants.get(node.input[1]) if len(node.input) > 1 else None
        return shape is not None and shape.size == 2

    def _activate(self, node: Any) -> None:
        activation = _OF_ONNX[node.op_type]
        usual = {"elu": 1.0, "leaky_relu": 0.01}.get(activation)
        alpha = attributes_of(node).get("alpha", usual)
        if usual is not None and abs(alpha - usual) > 1e-6:
            raise ValueError(f"{self.name}: {named(node)}: found alpha {alpha:g}, expected {usual:g}")
        if self.activation not in ("", activation):
            raise ValueError(f"{self.name}: {named(node)}: found {activation} behind {self.activation}, expected one kind")
        self.activation = activation

    def evaluate(self, x: np.ndarray) -> np.ndarray:
        """The graph itself, node by node, in double precision: not what was taken out of it."""
        values = {key: value.astype(np.float64) for key, value in self.graph.constants.items()
                  if value.dtype.kind in "fiu"} | {self.graph.inputs_in_order[0]: x}
        for node in self.graph.nodes:
            given = [values[n] for n in node.input if n in values]
            a = attributes_of(node)
            if node.op_type == "Gemm":
                left = given[0].T if a.get("transA") else given[0]
                right = given[1].T if a.get("transB") else given[1]
                result = a.get("alpha", 1.0) * (left @ right) + (a.get("beta", 1.0) * given[2] if len(given) > 2 else 0.0)
            elif node.op_type in ("MatMul", "Add", "Sub", "Mul", "Div"):
                result = {"MatMul": np.matmul, "Add": np.add, "Sub": np.subtract, "Mul": np.multiply,
                          "Div": np.divide}[node.op_type](given[0], given[1])
            elif node.op_type in _OF_ONNX:
                result = ACTIVATIONS[_OF_ONNX[node.op_type]](given[0])
            elif node.op_type == "Constant" or not given:
                continue
            else:
                result = given[0]
            values[node.output[0]] = result
        return values[self.graph.outputs[0]].reshape(len(x), -1)


def read_perceptron(weights: str | dict[str, np.ndarray], activation: str) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """(tensors, metadata) as bare weights with a golden example: that of the file (`golden_observation`,
    `golden_action`), or 50 random inputs whose answers are computed in double precision from the file or state_dict.
    `activation`: between the layers, where the file does not say."""
    name = weights if isinstance(weights, str) else "state_dict"
    metadata = {"origin": os.path.basename(name)}
    rest: dict[str, np.ndarray] = {}
    if name.endswith(".onnx"):
        network = _OnnxPerceptron(name)
        estimator, actor = [], network.layers
        if network.activation not in ("", activation):
            raise ValueError(f"{name}: found {network.activation} between the layers, the description says {activation}")
        evaluate = network.evaluate
    else:
        found = read_tensors(name) if isinstance(weights, str) else weights
        estimator, actor, rest = _from_state_dict(name, found)

        def evaluate(x: np.ndarray) -> np.ndarray:
            return _answers(estimator, actor, activation, x)

    inputs = (estimator or actor)[0][0].shape[1]
    observation = rest.get("golden_observation")
    if len(rest) == 1:
        raise ValueError(f"{name}: found {next(iter(rest))} alone, expected golden_observation and golden_action")
    if observation is None:
        observation = np.random.default_rng(1).normal(size=(GOLDEN_STEPS, inputs)).astype(np.float32)
        action = evaluate(observation.astype(np.float64)).astype(np.float32)
    else:
        action = rest["golden_action"]
        if observation.ndim != 2 or action.shape != (len(observation), 12) or not len(observation):
            raise ValueError(f"{name}: golden_observation: found shape {list(observation.shape)}, expected rows of "
                             f"{inputs} numbers, as many as in golden_action")
    rows = np.arange(GOLDEN_STEPS) % len(observation)
    tensors = {"golden.observation": observation[rows], "golden.action": action[rows]}
    for part, layers in (("estimator", estimator), ("actor", actor)):
        for number, (weight, bias) in enumerate(layers):
            tensors |= {f"{part}.{number}.weight": weight, f"{part}.{number}.bias": bias}
    return {key: np.ascontiguousarray(value, np.float32) for key, value in tensors.items()}, metadata
