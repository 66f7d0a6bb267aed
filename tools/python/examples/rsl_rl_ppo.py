#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""PPO of rsl_rl 5 on hard ground: trains the network of a policy file, whose file then runs in `sandrunner --policy FILE
--terrain rigid`. Needs PyTorch and rsl_rl (pip install rsl-rl-lib)."""

import argparse

import torch
from rsl_rl.models import RNNModel
from rsl_rl.modules import MLP, RNN
from rsl_rl.runners import OnPolicyRunner
from rsl_rl.utils import unpad_trajectories
from sandrunner import VectorEnv, write_policy
from sandrunner.rsl_rl import RslRlVecEnv

HARD_GROUND = {"ground.rigid_envs": 64, "ground.patchy_envs": 0}


class PolicyModel(RNNModel):
    """The layers of a policy file (policy/README.md). PPO trains the estimator like a hidden layer of the actor."""

    def __init__(self, obs, obs_groups, obs_set, output_dim, **config) -> None:
        super().__init__(obs, obs_groups, obs_set, output_dim, [256, 128], "lrelu", rnn_hidden_dim=64, **config)
        self.rnn = RNN(30, 64)
        self.estimator = MLP(64, 8, [128, 128], "lrelu")

    def get_latent(self, obs, masks=None, hidden_state=None):
        command, senses = obs["policy"][..., :3], obs["policy"][..., 3:]
        code = self.rnn(senses, masks, hidden_state).squeeze(0)
        if masks is not None:
            command = unpad_trajectories(command, masks)
        return torch.cat([command, code, self.estimator(code)], -1)

    def _get_latent_dim(self) -> int:
        return 3 + 64 + 8


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", default="walk.safetensors", help="policy file")
    parser.add_argument("--iterations", type=int, default=150, help="of 32 steps of each robot")
    parser.add_argument("--num-envs", type=int, default=1024)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--log", help="folder for TensorBoard and checkpoints")
    options = parser.parse_args()
    envs = VectorEnv("raibo", options.num_envs, 1, options.threads, HARD_GROUND, actions="modes")
    config = {
        "num_steps_per_env": 32,
        "save_interval": 50,
        "obs_groups": {"actor": ["policy"], "critic": ["critic"]},
        "algorithm": {"class_name": "PPO", "num_learning_epochs": 3, "learning_rate": 5e-4, "entropy_coef": 0.0},
        "actor": {
            "class_name": PolicyModel,
            "distribution_cfg": {"class_name": "GaussianDistribution", "init_std": 0.8, "std_type": "log"},
        },
        # Of no memory: it sees the true state.
        "critic": {"class_name": "MLPModel", "hidden_dims": [128, 128], "activation": "lrelu"},
    }
    runner = OnPolicyRunner(RslRlVecEnv(envs), config, options.log)
    runner.learn(options.iterations)
    weights = runner.get_inference_policy().state_dict()
    names = {name: name.replace("rnn.rnn.", "encoder.").replace("mlp.", "actor.") for name in weights}
    write_policy(options.out, {names[name]: tensor for name, tensor in weights.items()}, envs, "raibo, rsl_rl")
    print(f"{options.out}: reward {envs.statistics['reward']:.3f}, "
          f"{envs.statistics['falls_per_4s_hard']:.2f} falls in 4 s")


if __name__ == "__main__":
    main()
