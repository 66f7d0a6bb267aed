# SPDX-License-Identifier: BSD-3-Clause
"""Robots on sand: the environments, simulator, ground and policies of Sandrunner as numpy arrays."""

from ._native import __version__, terrain_preset_names
from .batch import Batch
from .ground import Ground
from .policies import Policy, import_policy, read_policy, write_policy
from .recording import Recording
from .vector_env import VectorEnv

__all__ = ["Batch", "Ground", "Policy", "Recording", "VectorEnv", "__version__", "import_policy", "read_policy",
           "terrain_preset_names", "write_policy"]

try:
    from gymnasium import register
except ImportError:
    pass
else:
    # gymnasium.make_vec("sandrunner/Raibo-v0", num_envs=64, ...): further keywords as VectorEnv's.
    for _id, _robot in (("sandrunner/Raibo-v0", "raibo"), ("sandrunner/Go2-v0", "go2")):
        register(_id, vector_entry_point="sandrunner:VectorEnv", kwargs={"robot": _robot})
