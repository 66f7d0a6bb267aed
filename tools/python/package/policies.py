# SPDX-License-Identifier: BSD-3-Clause
"""Policy files (policy/README.md): written from a network that was trained here, read, and run."""

import os
import tempfile
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from . import _check, _native
from .vector_env import VectorEnv
from .foreign import read_perceptron
from .weights import NETWORK, SCALES, read_weights, torch_names, write_safetensors

class PolicyFile(NamedTuple):
    """What `read_policy` returns."""

    tensors: dict[str, np.ndarray]  # by their names in the file, PyTorch's layout
    spec: dict[str, Any]  # joint names, nominal pose, gains, scales, provenance, ...


def _plain(name: str, tensor: Any) -> np.ndarray:
    if hasattr(tensor, "detach"):  # of PyTorch
        tensor = tensor.detach().cpu().numpy()
    array = np.asarray(tensor)
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{name}: found dtype {array.dtype}, expected numbers")
    return array.astype(np.float32)


def torch_state_dict(tensors: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The tensors of a policy file by PyTorch's names: those of the network of examples/ppo.py."""
    theirs = {ours: name for name, ours in torch_names().items()}
    return {theirs.get(name, name): tensor for name, tensor in tensors.items()}


def read_policy(path: str | os.PathLike[str]) -> PolicyFile:
    """Reads and checks a policy file, and runs its golden example. "raibo", "go2": the policy that ships for it."""
    return PolicyFile(*_native.read_policy(_check.path("path", path)))


def write_policy(
    path: str | os.PathLike[str],
    state_dict: Mapping[str, Any],
    env: VectorEnv,
    name: str = "",
    provenance: Mapping[str, str] | None = None,
) -> None:
    """Writes the policy file of a network that was trained in `env`.

    state_dict: float tensors or arrays of `encoder` (an LSTM), `estimator` and `actor` (policy/README.md has the
    shapes), by PyTorch's names or those of the file; others, of a critic say, are left out. Normalisation, gains,
    scales and commands are those of the environment; a normalisation in `state_dict` has to be the same."""
    if not isinstance(env, VectorEnv):
        raise ValueError(f"env: found {_check.shown(env)}, expected a VectorEnv")
    if not isinstance(state_dict, Mapping) or not all(isinstance(key, str) for key in state_dict):
        raise ValueError(f"state_dict: found {_check.shown(state_dict)}, expected tensors by name")
    renamed = torch_names()
    if "actor.4.weight" not in state_dict:
        renamed |= {ours: ours for ours in list(renamed.values())}
    for ours in [*NETWORK[:4], *SCALES[:2]]:
        renamed[ours] = ours
    tensors = {renamed[key]: _plain(key, value) for key, value in state_dict.items() if key in renamed}
    if provenance is not None and not isinstance(provenance, Mapping):
        raise ValueError(f"provenance: found {_check.shown(provenance)}, expected texts by name")
    texts = {"origin": "sandrunner in Python"} | dict(provenance or {})
    for key, value in texts.items():
        if not isinstance(key, str) or not isinstance(value, str):
            raise ValueError(f"provenance: found {_check.shown({key: value})}, expected texts")
    _native.write_policy(
        path=_check.path("path", path), tensors=tensors, environments=env._native, name=str(name), provenance=texts
    )


def import_policy(
    weights: str | os.PathLike[str] | Mapping[str, Any],
    path: str | os.PathLike[str],
    robot: str = "raibo",
    observation: str = "",
    name: str = "",
    settings: Mapping[str, Any] | None = None,
) -> None:
    """Writes the policy file of a network that was trained elsewhere.

    weights: a state_dict, or the file of one (npz, safetensors), or ONNX. observation: a description of what the
    network sees and how it answers, one that ships ("isaac_lab_go2", ...) or a file (tools/policy/README.md); empty: it
    is a network of policy/README.md. settings: other gains, scales or limits by the keys of policy/README.md."""
    robot, observation, name = str(robot), str(observation), str(name)
    if settings is not None and not isinstance(settings, Mapping):
        raise ValueError(f"settings: found {_check.shown(settings)}, expected values by key")
    if isinstance(weights, Mapping):
        source = {key: _plain(str(key), value) for key, value in weights.items()}
    else:
        source = _check.path("weights", weights)
    if observation:
        tensors, metadata = read_perceptron(source, _native.activation_in(observation, robot))
    elif isinstance(source, str):
        tensors, metadata = read_weights(source), {"origin": os.path.basename(source)}
    else:
        raise ValueError("weights: found a state_dict without a description, expected observation=..., or write_policy")
    output = _check.path("path", path)
    with tempfile.TemporaryDirectory() as folder:
        bare = os.path.join(folder, metadata["origin"])
        write_safetensors(bare, tensors, metadata)
        texts = {key: ",".join(map(str, v)) if isinstance(v, (list, tuple)) else str(v) for key, v in (settings or {}).items()}
        try:
            _native.import_policy(
                input=bare, output=output, name=name or os.path.splitext(os.path.basename(output))[0], robot=robot,
                observation=observation, settings=[f"{key}={text}" for key, text in texts.items()],
            )
        except ValueError as error:
            raise ValueError(str(error).replace(bare, metadata["origin"])) from None


class Policy:
    """A policy file that runs, with a memory for each robot. "raibo", "go2": the policy that ships for it."""

    def __init__(self, path: str | os.PathLike[str] = "raibo") -> None:
        self._native = _native.Policies(_check.path("path", path))

    def step(self, observation: np.ndarray, reset: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """One step of 10 ms, with the bits of the controller's. `observation`: (robots, 33), float32, raw
        (`VectorEnv.raw_observation`). Memories are cleared first where `reset`; all of them when the number of
        robots changes. Returns joint targets (robots, 12), rad, and estimates (robots, 8)."""
        if not isinstance(observation, np.ndarray) or observation.ndim != 2:
            raise ValueError(f"observation: found {_check.shown(observation)}, expected shape (robots, 33)")
        if reset is None:
            reset = np.zeros(len(observation), np.bool_)
        if not isinstance(reset, np.ndarray) or reset.dtype != np.bool_:
            raise ValueError(f"reset: found {_check.shown(reset)}, expected a truth value for each robot")
        return self._native.step(observation, reset.view(np.uint8))

    def act(self, env: VectorEnv, observation: np.ndarray, reset: np.ndarray | None = None) -> np.ndarray:
        """Actions for `env`, whose actions are joints', from what it showed."""
        if env.action_mode != "joints":
            raise ValueError("env: found actions = 'modes', expected 'joints': a policy file answers in them")
        if self._native.joint_names != env._native.joint_names:
            raise ValueError(
                f"env: found a robot with joint {env._native.joint_names[0]}, expected that of the policy, "
                f"with joint {self._native.joint_names[0]}"
            )
        targets, _ = self.step(env.raw_observation(observation).astype(np.float32), reset)
        return ((targets - env.nominal_position_rad) / env.action_scale_rad).astype(np.float32)
