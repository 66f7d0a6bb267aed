# SPDX-License-Identifier: BSD-3-Clause
"""The environments as rsl_rl's VecEnv has them (github.com/leggedrobotics/rsl_rl). Needs PyTorch."""

from typing import Any

import numpy as np
import torch

from .vector_env import ACTION_SIZE, VectorEnv

try:
    from rsl_rl.env import VecEnv as _Base
except ImportError:
    _Base = object

try:
    from tensordict import TensorDict
except ImportError:
    TensorDict = None


class RslRlVecEnv(_Base):
    """Wraps a VectorEnv for rsl_rl's OnPolicyRunner. Observation groups: "policy" (33) and "critic" (77).

    envs = RslRlVecEnv(VectorEnv(num_envs=4096, actions="modes"))
    OnPolicyRunner(envs, config, log_dir, device="cpu").learn(1000)
    """

    def __init__(self, envs: VectorEnv, device: str = "cpu") -> None:
        self.envs, self.device, self.cfg = envs, device, {"settings": envs.effective_settings}
        self.num_envs, self.num_actions = envs.num_envs, ACTION_SIZE
        self.max_episode_length = envs.max_episode_length
        # Steps since each episode began, as far as this object has seen. Episodes begin out of
        # step by themselves.
        self.episode_length_buf = torch.zeros(self.num_envs, dtype=torch.long, device=device)
        observation, info = envs.reset()
        self.num_obs, self.num_privileged_obs = observation.shape[1], info["privileged"].shape[1]
        self._observation, self._privileged = observation, info["privileged"]

    def _tensor(self, array: np.ndarray) -> torch.Tensor:
        return torch.from_numpy(array.copy()).to(self.device)

    def get_observations(self) -> Any:
        groups = {"policy": self._tensor(self._observation), "critic": self._tensor(self._privileged)}
        if TensorDict is None:
            return groups
        return TensorDict(groups, batch_size=[self.num_envs], device=self.device)

    def reset(self) -> tuple[Any, dict[str, Any]]:
        self._observation, info = self.envs.reset()
        self._privileged = info["privileged"]
        self.episode_length_buf.zero_()
        return self.get_observations(), {}

    def step(self, actions: torch.Tensor) -> tuple[Any, torch.Tensor, torch.Tensor, dict[str, Any]]:
        """Observations, rewards, dones, and extras: time_outs (the runner then adds the critic's value), log."""
        array = np.ascontiguousarray(actions.detach().cpu().numpy(), np.float32)
        self._observation, reward, terminated, truncated, info = self.envs.step(array)
        self._privileged = info["privileged"]
        dones = self._tensor(terminated | truncated)
        self.episode_length_buf = torch.where(dones, 0, self.episode_length_buf + 1)
        log = {f"reward/{name}": float(term.mean()) for name, term in info["reward_terms"].items()}
        extras = {"time_outs": self._tensor(truncated), "log": log}
        return self.get_observations(), self._tensor(reward), dones.long(), extras
