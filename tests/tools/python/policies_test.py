# SPDX-License-Identifier: BSD-3-Clause
"""Policy files and ONNX files: out, in, and the same answers."""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import numpy as np
from onnx_runtime import Session

from sandrunner import Policy, VectorEnv, read_policy, write_policy
from sandrunner.onnx_file import export_onnx, import_onnx
from sandrunner.policies import torch_state_dict

SHIPPED = pathlib.Path(os.environ["SANDRUNNER_ROOT"], "policy/trained/raibo.safetensors")
NODE_FOLDER = os.environ.get("SANDRUNNER_ONNXRUNTIME")  # where npm install onnxruntime-web was done


def walk(steps):
    """Raw observations of a robot that walks with the shipped policy, and its answers."""
    envs = VectorEnv(num_envs=64, seed=11, curriculum={"speed_mps": 2.0})
    policy, alone = Policy(), Policy()
    observation, info = envs.reset()
    rows, targets, estimates = [], [], []
    for _ in range(steps):
        row = envs.raw_observation(observation[:1]).astype(np.float32)
        target, estimate = alone.step(row)
        rows.append(row[0])
        targets.append(target[0])
        estimates.append(estimate[0])
        observation, *_, info = envs.step(policy.act(envs, observation, info["reset"]))
    return np.array(rows), np.array(targets), np.array(estimates)


class WithFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)


class Files(WithFolder):
    def test_the_shipped_file_and_the_built_in_policy_are_the_same(self):
        file, built_in = read_policy(SHIPPED), read_policy("raibo")
        self.assertEqual(file.spec, built_in.spec)
        for name, tensor in file.tensors.items():
            np.testing.assert_array_equal(tensor, built_in.tensors[name])

    def test_a_policy_ships_for_each_robot_by_its_name(self):
        for robot in ("raibo", "go2"):
            envs = VectorEnv(robot, num_envs=64)
            self.assertEqual(read_policy(robot).spec["joint_names"], envs.joint_names)
            self.assertEqual(Policy(robot).act(envs, envs.reset()[0]).shape, (64, 12))

    def test_a_policy_of_another_robot_is_refused(self):
        envs = VectorEnv("go2", num_envs=64)
        with self.assertRaisesRegex(ValueError, "^env: found a robot with joint FL_hip_joint, .* with joint LF_HAA$"):
            Policy("raibo").act(envs, envs.reset()[0])

    def test_the_file_is_a_safetensors_file(self):
        # As the format says: 8 bytes of header length, a JSON header of texts and tensors, the
        # data without holes.
        content = SHIPPED.read_bytes()
        size = int.from_bytes(content[:8], "little")
        header = json.loads(content[8 : 8 + size])
        metadata = header.pop("__metadata__")
        self.assertEqual({type(value) for value in metadata.values()}, {str})
        spans = sorted(tensor["data_offsets"] for tensor in header.values())
        self.assertEqual([0, *(end for _, end in spans)], [*(begin for begin, _ in spans), len(content) - 8 - size])
        self.assertEqual({tensor["dtype"] for tensor in header.values()}, {"F32"})
        for name, tensor in read_policy(SHIPPED).tensors.items():
            begin, end = header[name]["data_offsets"]
            values = np.frombuffer(content[8 + size + begin : 8 + size + end], "<f4").reshape(header[name]["shape"])
            np.testing.assert_array_equal(values, tensor)

    def test_a_network_that_answers_in_joints_comes_back_with_its_weights(self):
        envs = VectorEnv(num_envs=64)
        tensors = read_policy("raibo").tensors
        for names in (tensors, torch_state_dict(tensors)):
            write_policy(self.path("p.safetensors"), names, envs, name="mine", provenance={"note": "a test"})
            back = read_policy(self.path("p.safetensors"))
            self.assertEqual((back.spec["name"], back.spec["provenance"]["note"]), ("mine", "a test"))
            for name, tensor in tensors.items():
                np.testing.assert_allclose(back.tensors[name], tensor, rtol=1e-6)

    def test_a_network_that_answers_in_modes_is_written_in_joints(self):
        joints, modes = VectorEnv(num_envs=64, seed=2), VectorEnv(num_envs=64, seed=2, actions="modes")
        tensors = dict(read_policy("raibo").tensors)
        tensors["actor.2.weight"] = np.zeros((12, 128))
        bias = np.linspace(-0.3, 0.4, 12)
        tensors["actor.2.bias"] = bias
        write_policy(self.path("p.safetensors"), tensors, modes)
        answer = read_policy(self.path("p.safetensors")).tensors["actor.2.bias"]
        self.assertGreater(np.abs(answer - bias).max(), 0.1)
        for _ in range(5):
            a = joints.step(np.tile(answer, (64, 1)).astype(np.float32))[0]
            b = modes.step(np.tile(bias, (64, 1)).astype(np.float32))[0]
        np.testing.assert_allclose(a, b, atol=1e-3)

    def test_another_normalisation_than_the_environments_is_refused(self):
        tensors = dict(read_policy("raibo").tensors)
        tensors["observation.mean"] = tensors["observation.mean"] + 0.5
        with self.assertRaisesRegex(ValueError, r"^observation.mean: found 0.5 at 0, expected 0"):
            write_policy(self.path("p.safetensors"), tensors, VectorEnv(num_envs=64))
        self.assertEqual(os.listdir(self.folder.name), [])

    def test_a_written_policy_passes_the_check_of_sandrunner_policy(self):
        write_policy(self.path("p.safetensors"), read_policy("raibo").tensors, VectorEnv(num_envs=64))
        self.assertGreater(Policy(self.path("p.safetensors")).step(np.zeros((1, 33), np.float32))[0].size, 0)

    def test_a_policy_clears_a_memory_where_it_is_told_to(self):
        policy, row = Policy(), np.full((2, 33), 0.1, np.float32)
        first, _ = policy.step(row)
        second, _ = policy.step(row)
        self.assertGreater(np.abs(second - first).max(), 1e-3)
        third, _ = policy.step(row, np.array([True, False]))
        np.testing.assert_array_equal(third[0], first[0])
        self.assertGreater(np.abs(third[1] - first[1]).max(), 1e-3)


class Onnx(WithFolder):
    @classmethod
    def setUpClass(cls):
        cls.rows, cls.targets, cls.estimates = walk(200)

    def test_200_steps_of_the_shipped_policy_agree_with_the_controllers(self):
        export_onnx("raibo", self.path("p.onnx"))
        session = Session(self.path("p.onnx"))
        memory = {"h": np.zeros((1, 1, 64)), "c": np.zeros((1, 1, 64))}
        for row, target, estimate in zip(self.rows, self.targets, self.estimates, strict=True):
            out = session.run({"observation": row[None].astype(np.float64), **memory})
            memory = {"h": out["h_out"], "c": out["c_out"]}
            np.testing.assert_allclose(out["joint_target"][0], target, rtol=0, atol=1e-5)
            np.testing.assert_allclose(out["estimate"][0], estimate, rtol=0, atol=1e-5)

    @unittest.skipUnless(NODE_FOLDER and shutil.which("node"), "SANDRUNNER_ONNXRUNTIME names no folder of npm's onnxruntime-web")
    def test_200_steps_in_onnxruntime_agree_too(self):
        export_onnx("raibo", self.path("p.onnx"))
        self.rows.tofile(self.path("rows"))
        script = pathlib.Path(__file__).with_name("onnx_steps.mjs")
        words = ["node", script, self.path("p.onnx"), self.path("rows"), self.path("out")]
        subprocess.run(words, check=True, env={**os.environ, "NODE_FOLDER": NODE_FOLDER})
        out = np.fromfile(self.path("out"), np.float32).reshape(-1, 20)
        print(f"onnxruntime: largest difference {np.abs(out[:, :12] - self.targets).max():.1e} rad")
        np.testing.assert_allclose(out[:, :12], self.targets, rtol=0, atol=1e-5)
        np.testing.assert_allclose(out[:, 12:], self.estimates, rtol=0, atol=1e-5)

    def test_an_exported_file_comes_back_with_its_weights(self):
        export_onnx("raibo", self.path("p.onnx"))
        tensors = import_onnx(self.path("p.onnx"))
        for name, tensor in read_policy("raibo").tensors.items():
            np.testing.assert_allclose(tensors[name], tensor, rtol=1e-5, atol=1e-7)
        write_policy(self.path("back.safetensors"), tensors, VectorEnv(num_envs=64))

    def test_layers_as_matmul_and_add_are_recognised_too(self):
        import onnx
        from onnx import helper, numpy_helper

        export_onnx("raibo", self.path("p.onnx"))
        model = onnx.load(self.path("p.onnx"))
        constants = {t.name: t for t in model.graph.initializer}
        nodes = []
        for node in model.graph.node:
            if node.op_type == "Gemm":
                weight = constants[node.input[1]]
                transposed = numpy_helper.from_array(numpy_helper.to_array(weight).T.copy(), weight.name)
                weight.CopyFrom(transposed)
                product = node.output[0] + ".product"
                nodes += [helper.make_node("MatMul", [node.input[0], node.input[1]], [product]),
                          helper.make_node("Add", [product, node.input[2]], [node.output[0]])]
            else:
                nodes.append(node)
        del model.graph.node[:]
        model.graph.node.extend(nodes)
        onnx.save(model, self.path("q.onnx"))
        first, second = import_onnx(self.path("p.onnx")), import_onnx(self.path("q.onnx"))
        for name, tensor in first.items():
            np.testing.assert_array_equal(second[name], tensor)

    def test_a_file_of_other_layers_is_refused_by_name(self):
        import onnx

        with self.assertRaisesRegex(ValueError, "found no ONNX file"):
            import_onnx(SHIPPED)
        export_onnx("raibo", self.path("p.onnx"))
        model = onnx.load(self.path("p.onnx"))
        lstm = next(i for i, node in enumerate(model.graph.node) if node.op_type == "LSTM")
        del model.graph.node[lstm]
        onnx.save(model, self.path("q.onnx"))
        with self.assertRaisesRegex(ValueError, "^encoder: found 0 LSTM nodes, expected one"):
            import_onnx(self.path("q.onnx"))

    def test_another_network_with_the_same_layers_is_refused_at_its_node(self):
        import onnx
        from onnx import helper

        def nodes(model, kind):
            return [node for node in model.graph.node if node.op_type == kind]

        def tanh_behind_the_last_layer(model):
            last = nodes(model, "Gemm")[-1]
            last.output[0] = "unlimited"
            model.graph.node.append(helper.make_node("Tanh", ["unlimited"], ["action"]))
            model.producer_name = "another"  # ours has scales there

        def two_activations(model):
            first = nodes(model, "LeakyRelu")[0]
            model.graph.node.append(helper.make_node("Tanh", [first.output[0]], ["twice"]))
            nodes(model, "Gemm")[1].input[0] = "twice"

        def other_order(model):
            joined = nodes(model, "Concat")[0]
            parts = list(joined.input)
            del joined.input[:]
            joined.input.extend(reversed(parts))

        def peepholes(model):
            node = nodes(model, "LSTM")[0]
            node.input.extend([""] * (7 - len(node.input)) + ["p"])

        def other_split(model):
            node = nodes(model, "Split")[0]
            node.output[0], node.output[1] = node.output[1], node.output[0]

        activation = "^activation: found .*expected LeakyRelu of 0.01$"
        for change, pattern in (
            (lambda m: setattr(nodes(m, "LeakyRelu")[0], "op_type", "Elu"), activation),
            (lambda m: setattr(nodes(m, "LeakyRelu")[0].attribute[0], "f", 0.2), "^activation: found LeakyRelu of 0.2"),
            (two_activations, activation),
            (tanh_behind_the_last_layer, "(Tanh).*found behind the last layer, expected none$"),
            (lambda m: nodes(m, "Gemm")[0].attribute.append(helper.make_attribute("alpha", 2.0)), "found alpha 2"),
            (other_order, "found another input than command, encoding, estimate, in this order$"),
            (peepholes, "^encoder: found an LSTM with peepholes"),
            (lambda m: nodes(m, "LSTM")[0].attribute.append(helper.make_attribute("clip", 1.0)), "^encoder: .*clip 1"),
            (other_split, "(Split).*expected one Split of the observation into 3 and 30"),
        ):
            export_onnx("raibo", self.path("p.onnx"))
            model = onnx.load(self.path("p.onnx"))
            change(model)
            onnx.save(model, self.path("q.onnx"))
            with self.subTest(pattern=pattern), self.assertRaisesRegex(ValueError, pattern):
                import_onnx(self.path("q.onnx"))

    def test_a_network_of_anothers_making_comes_in_with_or_without_an_lstms_bias(self):
        import onnx

        export_onnx("raibo", self.path("p.onnx"))
        first = import_onnx(self.path("p.onnx"))
        model = onnx.load(self.path("p.onnx"))
        model.producer_name = "another"
        before = [n for n in model.graph.node if n.op_type in ("Sub", "Div", "Clip", "Mul", "Add")]
        split = next(n for n in model.graph.node if n.op_type == "Split")
        split.input[0] = "observation"
        for node in before:
            model.graph.node.remove(node)
        next(n for n in model.graph.node if n.op_type == "LSTM").input[3] = ""
        onnx.save(model, self.path("q.onnx"))
        second = import_onnx(self.path("q.onnx"))
        np.testing.assert_array_equal(second["actor.2.weight"], first["actor.2.weight"])
        np.testing.assert_array_equal(second["encoder.weight_hh"], first["encoder.weight_hh"])
        self.assertFalse(second["encoder.bias_ih"].any())
        self.assertNotIn("observation.mean", second)


if __name__ == "__main__":
    unittest.main()
