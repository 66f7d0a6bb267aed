#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Recurrent PPO in PyTorch: a robot learns to stand and walk on hard ground in 5 million transitions, and its policy
file runs in `sandrunner --policy FILE --terrain rigid`. Run with --help for the options."""

import argparse
import copy
import time

import numpy as np
import torch
from sandrunner import VectorEnv, write_policy
from torch import nn

WINDOW, MINIBATCHES, EPOCHS = 32, 4, 3
GAMMA, LAMBDA, CLIP, KL_TARGET, LEAST_STD = 0.99, 0.95, 0.2, 0.02, 0.18
HARD_GROUND = {"ground.rigid_envs": 64, "ground.patchy_envs": 0}


def mlp(*sizes: int, last: float = 1.0) -> nn.Sequential:
    layers: list[nn.Module] = []
    for inputs, outputs in zip(sizes, sizes[1:]):
        linear = nn.Linear(inputs, outputs)
        nn.init.normal_(linear.weight, std=inputs**-0.5 * (last if outputs == sizes[-1] else 1.0))
        nn.init.zeros_(linear.bias)
        layers += [linear, nn.LeakyReLU(0.01)]
    return nn.Sequential(*layers[:-1])


class Network(nn.Module):
    """The layers of a policy file (policy/README.md), and a critic that sees privileged observations."""

    def __init__(self, privileged: int) -> None:
        super().__init__()
        self.encoder = nn.LSTM(30, 64)
        nn.init.normal_(self.encoder.weight_ih_l0, std=30**-0.5)
        nn.init.normal_(self.encoder.weight_hh_l0, std=64**-0.5)
        for bias in (self.encoder.bias_ih_l0, self.encoder.bias_hh_l0):
            nn.init.zeros_(bias)
        self.encoder.bias_ih_l0.data[64:128] = 1.0  # it remembers at first
        self.estimator = mlp(64, 128, 128, 8)
        self.actor = mlp(75, 256, 128, 12, last=0.05)
        self.critic = mlp(privileged, 128, 128, 1, last=0.3)
        self.log_std = nn.Parameter(torch.full((12,), float(np.log(0.8))))

    def encode(self, observation, reset, memory):
        """Steps (time, robots, 33) of the encoder, whose memory is cleared before a step where `reset`."""
        out = []
        for x, keep in zip(observation[:, :, 3:], 1.0 - reset):
            memory = tuple(m * keep[None, :, None] for m in memory)
            y, memory = self.encoder(x[None], memory)
            out.append(y)
        return torch.cat(out), memory

    def answer(self, observation, code):
        estimate = self.estimator(code)
        return self.actor(torch.cat([observation[..., :3], code, estimate.detach()], -1)), estimate


def log_probability(action, mean, log_std):
    return (-0.5 * ((action - mean) / log_std.exp()) ** 2 - log_std).sum(-1)


def collect(envs, network, now, memory):
    """One window of experience: tensors (time, robots, ...), and where it ends."""
    rows = []
    for _ in range(WINDOW):
        with torch.no_grad():
            code, memory = network.encode(now["observation"][None], now["reset"][None], memory)
            mean, _ = network.answer(now["observation"], code[0])
            action = mean + network.log_std.exp() * torch.randn_like(mean)
            row = dict(now, action=action, mean=mean, value=network.critic(now["privileged"])[:, 0])
            observation, reward, terminated, truncated, info = envs.step(action.numpy())
            final = torch.zeros(envs.num_envs)
            if truncated.any():  # the future of an episode that was cut: what the critic expects
                final[truncated] = network.critic(torch.tensor(info["final_privileged"][truncated]))[:, 0]
        row.update(reward=torch.tensor(reward), end=torch.tensor(terminated | truncated), final=final)
        rows.append(row)
        now = seen(observation, info)
    return {key: torch.stack([row[key] for row in rows]) for key in rows[0]}, now, memory


def seen(observation, info):
    arrays = dict(observation=observation, privileged=info["privileged"], target=info["estimate_target"])
    return {key: torch.tensor(a) for key, a in arrays.items()} | {"reset": torch.tensor(info["reset"]).float()}


def advantages(w, last_value):
    following = torch.cat([w["value"][1:], last_value[None]])
    following = torch.where(w["end"], w["final"], following)
    errors = w["reward"] + GAMMA * following - w["value"]
    sums, total = [], torch.zeros_like(last_value)
    for error, end in zip(errors.flip(0), w["end"].flip(0)):
        total = error + GAMMA * LAMBDA * torch.where(end, 0.0, total)
        sums.append(total)
    return torch.stack(sums).flip(0)


def learn(network, optimizer, w, memory):
    """Epochs over the window; the learning rate follows the divergence from the policy that acted."""
    scaled = (w["advantage"] - w["advantage"].mean()) / (w["advantage"].std() + 1e-8)
    returns, old_std = w["advantage"] + w["value"], network.log_std.detach().clone()
    for _ in range(EPOCHS):
        for robots in torch.randperm(scaled.shape[1]).chunk(MINIBATCHES):
            part = {key: value[:, robots] for key, value in w.items()}
            code, _ = network.encode(part["observation"], part["reset"], tuple(m[:, robots] for m in memory))
            mean, estimate = network.answer(part["observation"], code)
            old = log_probability(part["action"], part["mean"], old_std)
            ratio = (log_probability(part["action"], mean, network.log_std) - old).exp()
            gain = torch.min(ratio * scaled[:, robots], ratio.clamp(1 - CLIP, 1 + CLIP) * scaled[:, robots])
            value = network.critic(part["privileged"])[..., 0]
            loss = -gain.mean() + 0.5 * ((value - returns[:, robots]) ** 2).mean()
            loss = loss + ((estimate - part["target"]) ** 2).mean()
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(network.parameters(), 1.0)
            with torch.no_grad():
                spread = (2 * (old_std - network.log_std)).exp() + ((mean - part["mean"]) / network.log_std.exp()) ** 2
                kl = (network.log_std - old_std + 0.5 * spread - 0.5).sum(-1).mean()
            group = optimizer.param_groups[0]
            group["lr"] *= 1.2 if kl < 0.5 * KL_TARGET else 1 / 1.3 if kl > 2 * KL_TARGET else 1.0
            group["lr"] = min(max(group["lr"], 2e-5), 2e-3)
            optimizer.step()
            network.log_std.data.clamp_(min=float(np.log(LEAST_STD)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", default="walk.safetensors", help="policy file")
    parser.add_argument("--transitions", type=float, default=5e6)
    parser.add_argument("--num-envs", type=int, default=1024)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    torch.manual_seed(options.seed)
    torch.set_num_threads(options.threads)
    envs = VectorEnv("raibo", options.num_envs, options.seed, options.threads, HARD_GROUND, actions="modes")
    observation, info = envs.reset()
    network, now = Network(info["privileged"].shape[1]), seen(observation, info)
    average = copy.deepcopy(network.state_dict())  # of the latest weights: it swings less
    optimizer = torch.optim.Adam(network.parameters(), lr=5e-4)
    memory, start = (torch.zeros(1, envs.num_envs, 64),) * 2, time.time()
    updates = max(1, round(options.transitions / envs.num_envs / WINDOW))
    for update in range(1, updates + 1):
        before = memory
        w, now, memory = collect(envs, network, now, memory)
        with torch.no_grad():
            w["advantage"] = advantages(w, network.critic(now["privileged"])[:, 0])
        learn(network, optimizer, w, before)
        for name, tensor in network.state_dict().items():
            average[name] += (tensor - average[name]) / min(update, 20)
        if update % 10 == 0 or update == updates:
            s, done = envs.statistics, update * WINDOW * envs.num_envs
            print(f"{done / 1e6:6.2f} M transitions, {time.time() - start:5.0f} s: reward {s['reward']:.3f}, "
                  f"speed {s['speed_ratio_hard']:.2f} of the commanded, {s['falls_per_4s_hard']:.2f} falls in 4 s, "
                  f"commands up to {envs.curriculum['speed_mps']:.2f} m/s", flush=True)
            write_policy(options.out, average, envs, name="raibo, ppo.py")


if __name__ == "__main__":
    main()
