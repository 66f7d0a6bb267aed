# SPDX-License-Identifier: BSD-3-Clause
"""The operators of an exported policy in numpy, each written from its definition in the ONNX specification and in
double precision: an evaluation of the file that shares no code with the exporter or the network."""

import numpy as np
import onnx
from onnx import helper, numpy_helper


def sigmoid(x):
    return 1.0 / (1.0 + np.exp(-x))


def lstm(x, w, r, b, _, h, c, hidden_size):
    """Y, Y_h, Y_c of one direction; gates in the order input, output, forget, cell."""
    outputs, h, c = [], h[0], c[0]
    for step in x:
        gates = step @ w[0].T + h @ r[0].T + b[0][: 4 * hidden_size] + b[0][4 * hidden_size :]
        i, o, f, g = np.split(gates, 4, axis=1)
        c = sigmoid(f) * c + sigmoid(i) * np.tanh(g)
        h = sigmoid(o) * np.tanh(c)
        outputs.append(h[None])
    return np.stack(outputs), h[None], c[None]


def gemm(a, b, c, transB=0):
    return a @ (b.T if transB else b) + c


OPERATORS = {
    "Add": lambda a, b: a + b,
    "Clip": np.clip,
    "Concat": lambda *parts, axis: np.concatenate(parts, axis=axis),
    "Div": lambda a, b: a / b,
    "Gemm": gemm,
    "LSTM": lstm,
    "LeakyRelu": lambda x, alpha: np.where(x < 0, alpha * x, x),
    "Mul": lambda a, b: a * b,
    "Split": lambda x, sizes, axis: np.split(x, np.cumsum(sizes.astype(int))[:-1], axis=axis),
    "Squeeze": lambda x, axes: np.squeeze(x, tuple(axes.astype(int))),
    "Sub": lambda a, b: a - b,
    "Unsqueeze": lambda x, axes: np.expand_dims(x, tuple(axes.astype(int))),
}


class Session:
    def __init__(self, path):
        self.graph = onnx.load(path).graph
        self.constants = {t.name: numpy_helper.to_array(t).astype(np.float64) for t in self.graph.initializer}

    def run(self, inputs):
        values = {"": None, **self.constants, **inputs}
        for node in self.graph.node:
            attributes = {a.name: helper.get_attribute_value(a) for a in node.attribute}
            results = OPERATORS[node.op_type](*(values[name] for name in node.input), **attributes)
            values.update(zip(node.output, results if isinstance(results, (tuple, list)) else [results]))
        return {output.name: values[output.name] for output in self.graph.output}
