# SPDX-License-Identifier: BSD-3-Clause
"""What cannot be used is a ValueError of one line, and the object goes on."""

import os
import unittest

import numpy as np

import sandrunner
from sandrunner import Batch, Ground, Policy, Recording, VectorEnv


class BadInput(unittest.TestCase):
    def refused(self, pattern, call, *arguments, **keywords):
        with self.assertRaises(ValueError) as caught:
            call(*arguments, **keywords)
        message = str(caught.exception)
        self.assertNotIn("\n", message)
        self.assertRegex(message, pattern)

    def test_of_the_environments_constructor(self):
        for pattern, arguments in {
            r"^spot: cannot be read .*, expected raibo, go2 or a robot file": {"robot": "spot"},
            r"^robot: found 5, expected": {"robot": 5},
            r"^num_envs: found 100, expected a multiple of learner.block_envs, which is 64": {"num_envs": 100},
            r"^num_envs: found 0, expected an integer from 1": {"num_envs": 0},
            r"^num_envs: found 64.0, expected an integer": {"num_envs": 64.0},
            r"^num_envs: found True": {"num_envs": True},
            r"^seed: found -1": {"seed": -1},
            r"^threads: found 1000": {"threads": 1000},
            r"^width: found 3, expected 1, 8 or 16": {"width": 3},
            r"^actions: found 'torque'": {"actions": "torque"},
            r"^curriculum: found 'yes'": {"curriculum": "yes"},
            r"^curriculum: found 'sped_mps', expected one of speed_mps": {"curriculum": {"sped_mps": 1}},
            r"^curriculum: found ground = 2, expected a number from 0 to 1": {"curriculum": {"ground": 2.0}},
            r"^curriculum: found ground = nan": {"curriculum": {"ground": float("nan")}},
            r"^settings: unknown key 'comand.yaw_radps'": {"settings": {"comand.yaw_radps": 1.0}},
            r"^settings: command.yaw_radps: found -1": {"settings": {"command.yaw_radps": -1.0}},
            r"^settings: command.yaw_radps: found nan": {"settings": {"command.yaw_radps": float("nan")}},
            r"^settings: command.yaw_radps: found .fast., expected": {"settings": ["command.yaw_radps=fast"]},
            r"^settings: found 'command.yaw_radps', expected PATH=VALUE": {"settings": ["command.yaw_radps"]},
            r"^settings: found command.yaw_radps = ": {"settings": {"command.yaw_radps": object()}},
            r"^settings: found 3": {"settings": 3},
            r"^settings: found array\('x'": {"settings": np.array("x")},
            r"command.yaw_radps.*'x'|command.yaw_radps.*\"x\"": {"settings": {"command.yaw_radps": np.array("x")}},
            r"no-such-file.toml": {"settings": "no-such-file.toml"},
        }.items():
            with self.subTest(arguments=arguments):
                self.refused(pattern, VectorEnv, **{"num_envs": 64, **arguments})

    def test_of_a_step(self):
        envs = VectorEnv(num_envs=64)
        good = np.zeros((64, 12), np.float32)
        bad = good.copy()
        bad[3, 5] = np.nan
        for pattern, actions in (
            (r"^actions: found shape \(64, 11\), expected \(64, 12\)", good[:, :11]),
            (r"^actions: found shape \(12,\)", good[0]),
            (r"^actions: found dtype float64, expected float32", good.astype(np.float64)),
            (r"^actions: found dtype object", good.astype(object)),
            (r"^actions: found list, expected a numpy array", good.tolist()),
            (r"^actions: found NoneType", None),
            (r"^actions: found nan at \[3, 5\], expected finite", bad),
        ):
            with self.subTest(pattern=pattern):
                self.refused(pattern, envs.step, actions)
        envs.step(np.zeros((12, 64), np.float32).T)  # rows apart are put together
        self.refused(r"^seed: found 'a'", envs.reset, seed="a")
        envs.close()
        self.refused(r"^VectorEnv: found a call after close", envs.step, good)

    def test_of_a_fork(self):
        envs = VectorEnv(num_envs=64)
        child = os.fork()
        if child == 0:
            try:
                envs.step(np.zeros((64, 12), np.float32))
            except ValueError as error:
                os._exit(0 if "forked" in str(error) else 1)
            os._exit(2)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)

    def test_of_a_batch(self):
        self.refused(r"^ground: 'moon' is neither a preset", Batch, ground="moon")
        self.refused(r"^num_robots: found 0", Batch, num_robots=0)
        self.refused(r"^step_hz: found 3", Batch, step_hz=3)
        self.refused(r"terrain.fricton", Batch, settings={"terrain.fricton": 1})
        self.refused(r"^terrain: found another foot", Batch, settings={"terrain.foot.shape": "disc"})
        batch = Batch(num_robots=3)
        self.refused(r"^ticks: found 0", batch.advance, 0)
        self.refused(r"^robots: found \[3\], expected indices from 0 to 2", batch.stand, [3])
        self.refused(r"^state: found shape \(3,\), expected \(2,\)", batch.set_state, batch.state, [0, 1])
        self.refused(r"^state: found another dtype", batch.set_state, np.zeros(3))
        state = batch.state.copy()
        state["contacts"]["region"][1, 2] = 1e9
        self.refused(r"^state: found contacts.region = 1000000000 at robot 1", batch.set_state, state)
        state = batch.state.copy()
        state["position"][2, 0] = np.inf
        self.refused(r"^state: found a number that is not finite at robot 2", batch.set_state, state)
        state = batch.state.copy()
        state["orientation"][1] = 0.0
        self.refused(r"^state: found an orientation of length 0 at robot 1, expected 1", batch.set_state, state)
        for change, pattern in (
            (lambda m: m["base"].__setitem__("mass", -5), r"base.mass = -5 at robot 0, expected at least 0.001"),
            (lambda m: m["base"].__setitem__("inertia", 0), r"base.inertia 0 0 0 0 0 0 at robot 0, expected one that"),
            (lambda m: m["legs"]["shank"].__setitem__("mass", 0), r"legs.shank.mass = 0 at robot 0, expected at least"),
            (lambda m: m["legs"].__setitem__("sign", 0.5), r"legs.sign 0.5 at robot 0, expected 1 or -1"),
            (lambda m: m.__setitem__("foot_radius_m", -1), r"foot_radius_m = -1 at robot 0, expected at least"),
            (lambda m: m.__setitem__("torque_limit_nm", -5), r"torque_limit_nm = -5 at robot 0, expected at least"),
            (lambda m: m.__setitem__("lower_rad", 9), r"lower_rad = 9 and upper_rad = .* expected the lower one first"),
            (lambda m: m.__setitem__("rotor_inertia", -1), r"rotor_inertia = -1 at robot 0, expected at least 0"),
            (lambda m: m.__setitem__("base_box_half_m", 0), r"base_box_half_m = 0 at robot 0, expected at least"),
        ):
            model = batch.model
            change(model)
            self.refused(r"^model: found " + pattern, batch.set_model, model)
        for name in ("kp", "kd", "torque_scale", "stall_torque_nm", "inverse_no_load_speed", "heat_factor"):
            before = batch.drive[name].copy()
            batch.drive[name][1] = -1
            self.refused(rf"^drive: found {name} = -1 at robot 1, expected at least 0", batch.advance, 1)
            batch.drive[name] = before
        batch.targets[0, 0] = np.nan
        self.refused(r"^drive: found a number that is not finite at robot 0", batch.advance, 1)
        with self.assertRaises(ValueError):  # numpy's: read-only
            batch.state["position"][0] = 0.0

    def test_of_the_ground(self):
        self.refused(r"^ground: found 'rigid', which is hard", Ground, "rigid")
        self.refused(r"^ground: found 'air-mattress', which couples", Ground, "air-mattress")
        self.refused(r"^foot_radius_m: found 0, expected", Ground, foot_radius_m=0)
        ground, contacts = Ground(), Ground.contacts(2)
        still = np.zeros((2, 3))
        self.refused(r"^position: found shape \(3,\)", ground.step, contacts, still[0], still, 1e-3)
        self.refused(r"^velocity: found dtype float32", ground.step, contacts, still, still.astype(np.float32), 1e-3)
        self.refused(r"^velocity: found nan at \[0, 0\]", ground.step, contacts, still, still * np.nan, 1e-3)
        self.refused(r"^step_s: found 0", ground.step, contacts, still, still, 0.0)
        self.refused(r"^contacts: found rows apart", ground.step, Ground.contacts(4)[::2], still, still, 1e-3)
        self.refused(r"^contacts: found another array", ground.step, np.zeros(2), still, still, 1e-3)
        contacts["region"][1] = 77
        self.refused(r"^contacts: found region 77 at foot 1", ground.step, contacts, still, still, 1e-3)

    def test_of_policies(self):
        self.refused(r"no-such.safetensors", Policy, "no-such.safetensors")
        self.refused(r"no-such.safetensors", sandrunner.read_policy, "no-such.safetensors")
        policy = Policy()
        self.refused(r"^observation: found array", policy.step, np.zeros(33, np.float32))
        self.refused(r"^observation: found shape \(2, 32\), expected \(2, 33\)", policy.step, np.zeros((2, 32), np.float32))
        self.refused(r"^reset: found", policy.step, np.zeros((2, 33), np.float32), [True, False])
        envs = VectorEnv(num_envs=64)
        self.refused(r"^state_dict: found no 'encoder.weight_ih'", sandrunner.write_policy, "x", {}, envs)
        tensors = dict(sandrunner.read_policy("raibo").tensors)
        tensors["actor.2.bias"] = np.zeros(11)
        self.refused(r"^actor.2.bias: found shape \(11,\)", sandrunner.write_policy, "x", tensors, envs)
        tensors["actor.2.bias"] = np.full(12, np.nan)
        self.refused(r"^actor.2.bias: found nan", sandrunner.write_policy, "x", tensors, envs)
        self.refused(r"^env: found 3", sandrunner.write_policy, "x", tensors, 3)

    def test_of_a_recording(self):
        envs = VectorEnv(num_envs=64)
        self.refused(r"^env: found 64, expected an integer from 0 to 63", Recording, envs, 64)
        self.refused(r"^Recorder: found no step", Recording(envs).write, "/tmp/never-written.html")


if __name__ == "__main__":
    unittest.main()
