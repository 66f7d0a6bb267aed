# SPDX-License-Identifier: BSD-3-Clause
"""The network of a policy file (policy/README.md) out of an ONNX file of any maker. The graph is followed node by node
from the last layer to the inputs: a node that makes another network of it is a ValueError that names it."""

from typing import Any

import numpy as np

HIDDEN, INPUTS, COMMAND = 64, 30, 3
# All layers differ in shape, by which those of an ONNX file are recognised: (outputs, inputs).
DENSE = {
    "estimator.0": (128, 64),
    "estimator.1": (128, 128),
    "estimator.2": (8, 128),
    "actor.0": (256, 75),
    "actor.1": (128, 256),
    "actor.2": (12, 128),
}
# They move numbers and change none.
_SHAPING = ("Cast", "Dropout", "Flatten", "Identity", "Reshape", "Squeeze", "Transpose", "Unsqueeze")


def gates(matrix: np.ndarray, order: tuple[int, ...]) -> np.ndarray:
    """The blocks of the four gates in another order."""
    return np.concatenate([np.split(matrix, 4)[i] for i in order])


# PyTorch and policy files: input, forget, cell, output. ONNX: input, output, forget, cell.
TO_ONNX, FROM_ONNX = (0, 3, 1, 2), (0, 2, 3, 1)


def attributes_of(node: Any) -> dict[str, Any]:
    from onnx import helper

    return {a.name: helper.get_attribute_value(a) for a in node.attribute}


def named(node: Any) -> str:
    return f"node '{node.name or node.output[0]}' ({node.op_type})"


class Graph:
    def __init__(self, graph: Any, producer: str) -> None:
        from onnx import numpy_helper

        self.producer = producer
        self.nodes = list(graph.node)
        self.maker = {output: node for node in self.nodes for output in node.output if output}
        self.inputs = {value.name for value in graph.input}
        self.outputs = [value.name for value in graph.output]
        self.constants = {tensor.name: numpy_helper.to_array(tensor) for tensor in graph.initializer}
        for node in self.nodes:
            if node.op_type == "Constant" and (value := attributes_of(node).get("value")) is not None:
                self.constants[node.output[0]] = numpy_helper.to_array(value)

        self.nodes = self._in_order(self.nodes)
        self.inputs_in_order = [value.name for value in graph.input if value.name not in self.constants]

    def _in_order(self, nodes: list[Any]) -> list[Any]:
        """Each node behind what it reads; a circle is a ValueError."""
        known, ordered, waiting = self.inputs | self.constants.keys(), [], nodes
        while waiting:
            ready = [node for node in waiting if all(n in known or n not in self.maker for n in node.input)]
            clash = next((node for node in ready if set(node.output) & self.inputs), None)
            if clash is not None or not ready:
                raise ValueError(f"{named(clash or waiting[0])}: found a circle, expected layers behind each other")
            for node in ready:
                known |= set(node.output)
            ordered += ready
            waiting = [node for node in waiting if node not in ready]
        return ordered

    def dense(self, node: Any) -> "Dense":
        weight = self.constants.get(node.input[1])
        if weight is None or weight.ndim != 2 or weight.dtype.kind != "f":
            raise ValueError(f"{named(node)}: found no weights, expected a constant matrix of floats")
        return Dense(self, node)

    def source(self, name: str) -> str:
        """The value that `name` is but for its shape."""
        while (node := self.maker.get(name)) is not None and node.op_type in _SHAPING:
            name = node.input[0]
        return name

    def hangs(self, name: str) -> bool:
        """Whether nothing makes this value, so that the graph says nothing of the wiring there."""
        return self.source(name) not in self.maker.keys() | self.inputs | self.constants.keys()

    def users(self, name: str) -> list[Any]:
        """What takes this value, but for its shape."""
        found = []
        for node in self.nodes:
            if name in node.input:
                found += self.users(node.output[0]) if node.op_type in _SHAPING else [node]
        return found

    def constant(self, name: str, of: str, shape: tuple[int, ...]) -> np.ndarray:
        value = self.constants.get(name)
        if value is None or value.shape != shape:
            found = "none" if value is None else list(value.shape)
            raise ValueError(f"{of}: found weights of shape {found}, expected {list(shape)}")
        return value


class Dense:
    """A Gemm, or a MatMul with the Add behind it: weight (outputs, inputs), bias (outputs), the values before and
    behind it."""

    def __init__(self, graph: Graph, node: Any) -> None:
        weight = graph.constants[node.input[1]]
        attributes = {"alpha": 1.0, "beta": 1.0, "transA": 0, "transB": 0} | attributes_of(node)
        self.node, self.input, self.output, bias = node, node.input[0], node.output[0], ""
        if node.op_type == "Gemm":
            if attributes["alpha"] != 1.0 or attributes["beta"] != 1.0 or attributes["transA"]:
                raise ValueError(f"{named(node)}: found alpha {attributes['alpha']:g}, beta {attributes['beta']:g}, "
                                 f"transA {attributes['transA']}, expected 1, 1, 0")
            bias = node.input[2] if len(node.input) > 2 else ""
        else:
            behind = graph.users(self.output)
            if len(behind) == 1 and behind[0].op_type == "Add":
                bias = next((name for name in behind[0].input if name in graph.constants), "")
                self.output = behind[0].output[0] if bias else self.output
        self.weight = weight if attributes["transB"] and node.op_type == "Gemm" else weight.T
        self.bias = graph.constants.get(bias, np.zeros(self.weight.shape[0], np.float32)).reshape(-1)


def _dense_layers(graph: Graph) -> dict[str, Dense]:
    layers: dict[str, Dense] = {}
    for node in graph.nodes:
        if node.op_type not in ("Gemm", "MatMul") or node.input[1] not in graph.constants:
            continue
        dense = Dense(graph, node)
        layer = next((name for name, shape in DENSE.items() if shape == dense.weight.shape), None)
        if layer is None:
            raise ValueError(f"{named(node)}: found weights of shape {list(dense.weight.shape)}, expected those of a "
                             "policy file")
        if layer in layers:
            raise ValueError(f"{layer}: found two layers of shape {list(DENSE[layer])}, expected one")
        layers[layer] = dense
    for layer, shape in DENSE.items():
        if layer not in layers:
            raise ValueError(f"{layer}: found no dense layer of shape {list(shape)}, expected one")
    return layers


def _require_activation(graph: Graph, before: Dense, behind: Dense) -> None:
    """A leaky ReLU of 0.01 and nothing else lies between two layers."""
    if graph.hangs(behind.input):
        return
    node = graph.maker.get(graph.source(behind.input))
    if node is None or node.op_type != "LeakyRelu":
        found = "no activation" if node is before.node or node is None else named(node)
        raise ValueError(f"activation: found {found} before {named(behind.node)}, expected LeakyRelu of 0.01")
    slope = attributes_of(node).get("alpha", 0.01)
    if abs(slope - 0.01) > 1e-6:
        raise ValueError(f"activation: found LeakyRelu of {slope:g} at {named(node)}, expected LeakyRelu of 0.01")
    if graph.source(node.input[0]) != before.output:
        raise ValueError(f"{named(node)}: found another input than {named(before.node)}")


def _lstm(graph: Graph) -> Any:
    nodes = [node for node in graph.nodes if node.op_type in ("LSTM", "GRU", "RNN")]
    if len(nodes) != 1 or nodes[0].op_type != "LSTM":
        raise ValueError(f"encoder: found {sum(n.op_type == 'LSTM' for n in nodes)} LSTM nodes, expected one")
    node, attributes = nodes[0], attributes_of(nodes[0])
    usual = {"direction": b"forward", "activations": [b"Sigmoid", b"Tanh", b"Tanh"], "input_forget": 0, "clip": 0.0}
    for name, value in usual.items():
        if attributes.get(name, value) != value:
            raise ValueError(f"encoder: found another kind of LSTM ({name} {attributes[name]}), expected one forward "
                             "with its usual activations")
    if len(node.input) > 7 and node.input[7]:
        raise ValueError("encoder: found an LSTM with peepholes, expected one without")
    return node


def _lstm_weights(graph: Graph, node: Any) -> dict[str, np.ndarray]:
    w = graph.constant(node.input[1], "encoder", (1, 4 * HIDDEN, INPUTS))[0]
    r = graph.constant(node.input[2], "encoder", (1, 4 * HIDDEN, HIDDEN))[0]
    bias = np.zeros(8 * HIDDEN, np.float32)  # left out, by an empty name too
    if len(node.input) > 3 and node.input[3]:
        bias = graph.constant(node.input[3], "encoder", (1, 8 * HIDDEN))[0]
    bias_ih, bias_hh = np.split(bias, 2)
    parts = {"weight_ih": w, "weight_hh": r, "bias_ih": bias_ih, "bias_hh": bias_hh}
    return {f"encoder.{name}": gates(part, FROM_ONNX) for name, part in parts.items()}


def _require_wiring(graph: Graph, lstm: Any, layers: dict[str, Dense], is_ours: bool) -> None:
    encodings = {graph.source(name) for name in lstm.output if name}
    first, last = layers["estimator.0"], layers["actor.2"]
    if graph.source(first.input) not in encodings and not graph.hangs(first.input):
        raise ValueError(f"{named(first.node)}: found another input than the LSTM's output")
    for part in ("estimator", "actor"):
        for number in (1, 2):
            _require_activation(graph, layers[f"{part}.{number - 1}"], layers[f"{part}.{number}"])
    behind = graph.users(last.output)
    if behind and not is_ours:
        raise ValueError(f"{named(behind[0])}: found behind the last layer, expected none")
    actor = layers["actor.0"]
    if graph.hangs(actor.input):
        return
    joined = graph.maker.get(graph.source(actor.input))
    parts = [graph.source(name) for name in joined.input] if joined is not None and joined.op_type == "Concat" else []
    if len(parts) != 3 or parts[1] not in encodings or parts[2] != layers["estimator.2"].output:
        raise ValueError(f"{named(actor.node)}: found another input than command, encoding, estimate, in this order")
    _require_split(graph, parts[0], graph.source(lstm.input[0]), is_ours)


def _require_split(graph: Graph, command: str, rest: str, is_ours: bool) -> None:
    """The observation's first three values are the command, the others go into the LSTM, as they are."""
    node = graph.maker.get(command)
    if node is None and graph.maker.get(rest) is None and command != rest:
        return  # two inputs
    if node is not None and node.op_type == "Split" and node is graph.maker.get(rest):
        sizes = graph.constants.get(node.input[1]) if len(node.input) > 1 else attributes_of(node).get("split")
        whole = graph.source(node.input[0])
        in_order = list(node.output[:2]) == [command, rest] and sizes is not None and list(sizes) == [COMMAND, INPUTS]
        if in_order and (is_ours or graph.maker.get(whole) is None):
            return
        node = graph.maker.get(whole, node) if in_order else node
    where = node or graph.maker.get(rest)
    raise ValueError(f"{named(where)}: found before the LSTM and the actor, expected one Split of the observation into "
                     f"{COMMAND} and {INPUTS}, or two inputs")


def load_graph(name: str) -> Graph:
    try:
        import onnx
    except ImportError:
        raise ValueError(f"{name}: needs the Python package onnx (Debian: python3-onnx)") from None
    try:
        model = onnx.load(name)
    except Exception as error:  # of protobuf, whose classes differ from version to version
        raise ValueError(f"{name}: found no ONNX file: {str(error).splitlines()[0] if str(error) else error!r}") from None
    return Graph(model.graph, model.producer_name)


def read_onnx(name: str) -> dict[str, np.ndarray]:
    """An LSTM and six dense layers, wired as in a policy file. Of a file of `export_onnx`, the scales come along.
    Raises ValueError, one line, for any other network."""
    graph = load_graph(name)
    lstm, is_ours = _lstm(graph), graph.producer == "sandrunner"
    tensors = _lstm_weights(graph, lstm)
    layers = _dense_layers(graph)
    _require_wiring(graph, lstm, layers, is_ours)
    for layer, dense in layers.items():
        tensors |= {f"{layer}.weight": dense.weight, f"{layer}.bias": dense.bias}
    if is_ours:
        for of, floor in (("observation", 1e-8), ("estimate", 0.0)):
            tensors[f"{of}.mean"] = graph.constants[f"{of}.mean"]
            tensors[f"{of}.variance"] = graph.constants[f"{of}.deviation"].astype(np.float64) ** 2 - floor
    return {key: np.ascontiguousarray(value, np.float32) for key, value in tensors.items()}
