# SPDX-License-Identifier: BSD-3-Clause
"""Robots on sand: the environments, simulator, ground and policies of Sandrunner as numpy arrays."""

from ._native import __version__, terrain_preset_names
from .batch import Batch
from .ground import Ground
from .policies import Policy, read_policy, write_policy
from .recording import Recording
from .vector_env import VectorEnv

__all__ = ["Batch", "Ground", "Policy", "Recording", "VectorEnv", "__version__", "read_policy", "terrain_preset_names",
           "write_policy"]
