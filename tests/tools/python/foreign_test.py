# SPDX-License-Identifier: BSD-3-Clause
"""Networks of others: a state_dict, its files and ONNX become policies that answer as they do."""

import os
import pathlib
import tempfile
import unittest

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from sandrunner import Policy, import_policy
from sandrunner.foreign import read_perceptron

SHARED = pathlib.Path(os.environ["SANDRUNNER_ROOT"], "../shared/reference-policy/go2")
# Isaac Lab counts joints by their place on the leg; a robot by its legs.
ISAAC_JOINT_OF = [0, 3, 6, 9, 1, 4, 7, 10, 2, 5, 8, 11]
POSE = np.array([0.1, -0.1, 0.1, -0.1, 0.8, 0.8, 1.0, 1.0, -1.5, -1.5, -1.5, -1.5])
SIZES = (45, 32, 24, 12)


def random_state_dict(seed=1):
    """As rsl_rl saves one; the numbers in the names count activations, too."""
    rng = np.random.default_rng(seed)
    state = {"std": np.ones(12), "critic.0.weight": np.ones((4, 45))}
    for k, (inputs, outputs) in enumerate(zip(SIZES, SIZES[1:])):
        state[f"actor.{2 * k}.weight"] = rng.normal(size=(outputs, inputs)) / np.sqrt(inputs)
        state[f"actor.{2 * k}.bias"] = 0.1 * rng.normal(size=outputs)
    return state


def elu(x):
    return np.where(x > 0, x, np.expm1(np.minimum(x, 0)))


def answer(state, x, mean=0.0, deviation=1.0):
    x = (x - mean) / deviation
    for k in range(3):
        x = state[f"actor.{2 * k}.weight"] @ x + state[f"actor.{2 * k}.bias"]
        x = elu(x) if k < 2 else x
    return x


def onnx_model(state, mean, deviation, activation=("Elu", {}), between=()):
    """As rsl_rl's exporter writes it, with the normaliser in front."""
    constants = {"mean": np.float32(mean), "deviation": np.float32(deviation)}
    nodes = [helper.make_node("Sub", ["obs", "mean"], ["centred"]), helper.make_node("Div", ["centred", "deviation"], ["h"])]
    value = "h"
    for k in range(3):
        for kind in ("weight", "bias"):
            constants[f"actor.{2 * k}.{kind}"] = state[f"actor.{2 * k}.{kind}"].astype(np.float32)
        out = "actions" if k == 2 else f"dense{k}"
        nodes.append(helper.make_node("Gemm", [value, f"actor.{2 * k}.weight", f"actor.{2 * k}.bias"], [out], transB=1))
        if k < 2:
            value = f"activated{k}"
            nodes.append(helper.make_node(activation[0], [out], [value], name=f"/actor/{k}", **activation[1]))
            for number, node in enumerate(between):
                nodes.append(helper.make_node(node, [value], [f"{value}.{number}"]))
                value = f"{value}.{number}"
    info = [helper.make_tensor_value_info(name, TensorProto.FLOAT, [1, size]) for name, size in (("obs", 45), ("actions", 12))]
    tensors = [numpy_helper.from_array(np.asarray(a, np.float32), name) for name, a in constants.items()]
    return helper.make_model(helper.make_graph(nodes, "actor", info[:1], info[1:], tensors))


class Foreign(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.state = random_state_dict()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def answers_as(self, weights, mean=0.0, deviation=1.0):
        import_policy(weights, self.path("theirs.safetensors"), robot="go2", observation="isaac_lab_go2")
        policy = Policy(self.path("theirs.safetensors"))
        rng, last = np.random.default_rng(2), np.zeros(12)
        for step in range(20):
            raw = rng.normal(size=33).astype(np.float32)
            if step % 2 == 0:  # 50 Hz
                q, qd = raw[9:21][ISAAC_JOINT_OF], raw[21:33][ISAAC_JOINT_OF]
                seen = np.concatenate([raw[6:9], -raw[3:6], raw[:3], q - POSE, qd, last])
                last = answer(self.state, seen, mean, deviation)
            target, _ = policy.step(raw[None])
            np.testing.assert_allclose(target[0][ISAAC_JOINT_OF], POSE + 0.25 * last, atol=2e-5)

    def test_a_himloco_state_dict_gives_its_encoder_and_not_its_target(self):
        rng = np.random.default_rng(3)
        state = {"critic.0.weight": np.ones((4, 45)), "estimator.proto.weight": np.ones((16, 16))}
        for part, sizes in (("estimator.encoder", (270, 32, 19)), ("estimator.target", (45, 32, 16)), ("actor", (64, 32, 12))):
            for k, (inputs, outputs) in enumerate(zip(sizes, sizes[1:])):
                state[f"{part}.{2 * k}.weight"] = rng.normal(size=(outputs, inputs)) / np.sqrt(inputs)
                state[f"{part}.{2 * k}.bias"] = 0.1 * rng.normal(size=outputs)
        import_policy(state, self.path("theirs.safetensors"), robot="go2", observation="himloco_go2")
        Policy(self.path("theirs.safetensors"))

    def test_a_state_dict_walks_in_three_lines(self):
        self.answers_as(self.state)

    def test_its_npz_does(self):
        np.savez(self.path("theirs.npz"), **self.state)
        self.answers_as(self.path("theirs.npz"))

    def test_a_normaliser_becomes_part_of_the_first_layer(self):
        mean, std = np.linspace(-0.5, 0.5, 45), np.linspace(0.5, 2.0, 45)
        self.answers_as(self.state | {"actor_obs_normalizer._mean": mean[None], "actor_obs_normalizer._std": std[None],
                                      "actor_obs_normalizer.count": np.array(7)}, mean, std + 1e-2)

    def test_onnx_with_its_normaliser_answers_as_the_graph(self):
        mean, deviation = np.linspace(-0.5, 0.5, 45), np.linspace(0.5, 2.0, 45)
        onnx.save(onnx_model(self.state, mean, deviation, between=("Identity",)), self.path("theirs.onnx"))
        self.answers_as(self.path("theirs.onnx"), mean, deviation)

    def test_a_graph_that_is_something_else_is_refused_by_its_node(self):
        zeros, ones = np.zeros(45), np.ones(45)
        cases = [
            (onnx_model(self.state, zeros, ones, ("Elu", {"alpha": 0.5})), "alpha 0.5, expected 1"),
            (onnx_model(self.state, zeros, ones, ("Softplus", {})), r"node '/actor/0' \(Softplus\): not understood"),
            (onnx_model(self.state, zeros, ones, ("Tanh", {})), "found tanh between the layers, the description says elu"),
            (onnx_model(self.state, zeros, ones, between=("Sin",)), r"\(Sin\): not understood"),
            (onnx_model(self.state, zeros, ones, between=("Transpose",)), r"\(Transpose\): not understood"),
            (onnx_model(self.state, zeros, ones, between=("Elu",)), r"\(Elu\): not understood"),
        ]
        circle = onnx_model(self.state, zeros, ones)
        circle.graph.node[2].input[0] = "actions"
        cases.append((circle, "found a circle"))
        for model, cause in cases:
            onnx.save(model, self.path("theirs.onnx"))
            with self.assertRaisesRegex(ValueError, cause):
                import_policy(self.path("theirs.onnx"), self.path("out"), robot="go2", observation="isaac_lab_go2")
            self.assertFalse(os.path.exists(self.path("out")))

    def test_wrong_weights_and_descriptions_are_named(self):
        cases = [
            ({"memory_a.rnn.weight_ih_l0": np.ones((4, 4))}, {}, "tensor 'memory_a.rnn.weight_ih_l0', expected layers"),
            ({"actor.4.bias": np.ones(7)}, {}, r"actor.4: found weight \[12, 24\] and bias \[7\]"),
            ({"actor.0.weight": np.ones((32, 48))}, {}, r"'actor.0.weight' has shape \[32, 48\], expected \[32, 45\]"),
            ({"golden_observation": np.ones((50, 45)), "golden_action": np.ones((50, 12))}, {}, "golden example fails"),
            ({"golden_observation": np.ones((50, 45))}, {}, "found golden_observation alone"),
            ({"actor.0.weight": np.array(1.0)}, {}, r"actor.0: found weight \[1\]"),
            ({3: np.ones(4)}, {}, "tensor 3 is not of numbers by a name"),
            ({}, {"settings": ["kp"]}, "settings: found"),
            ({}, {"observation": "isaac"}, "expected a file or one of himloco_go2, isaac_lab_go2"),
            ({}, {"robot": "raibo"}, "expected each joint of robot 'raibo' once"),
            ({}, {"settings": {"kp_nmprad": -1}}, "expected at least 0"),
        ]
        for tensors, arguments, cause in cases:
            arguments = {"robot": "go2", "observation": "isaac_lab_go2"} | arguments
            with self.assertRaisesRegex(ValueError, cause):
                import_policy(self.state | tensors, self.path("out"), **arguments)
            self.assertFalse(os.path.exists(self.path("out")), cause)

    @unittest.skipUnless(SHARED.is_dir(), "needs the published policies")
    def test_published_policies_equal_their_golden_answers(self):
        for name, description in (("mlp-robot-lab", "robot_lab_go2"), ("himloco", "himloco_go2")):
            import_policy(str(SHARED / f"{name}.npz"), self.path("theirs"), robot="go2", observation=description)
            Policy(self.path("theirs"))  # runs the example of the file
            found = np.load(SHARED / f"{name}.npz")
            tensors, _ = read_perceptron(str(SHARED / f"{name}.npz"), "elu")
            np.testing.assert_array_equal(tensors["golden.action"], found["golden_action"])
            bare = {key: found[key] for key in found.files if not key.startswith("golden")}
            # Answers to random inputs are computed from the weights.
            import_policy(bare, self.path("theirs"), robot="go2", observation=description)


if __name__ == "__main__":
    unittest.main()
