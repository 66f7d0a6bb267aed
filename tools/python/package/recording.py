# SPDX-License-Identifier: BSD-3-Clause
"""An episode of one robot as a page."""

import os

from . import _check, _native
from .vector_env import VectorEnv


class Recording:
    """Follows robot `env` of a VectorEnv to the end of its episode.

    recording = Recording(envs, 0)
    while recording.add():          # after reset, and after every step
        envs.step(policy(...))
    recording.write("run.html")     # opens in a browser
    """

    def __init__(self, envs: VectorEnv, env: int = 0) -> None:
        if not isinstance(envs, VectorEnv):
            raise ValueError(f"envs: found {_check.shown(envs)}, expected a VectorEnv")
        self._native = _native.Recorder(envs._native, _check.integer("env", env, 0, envs.num_envs - 1))

    def add(self) -> bool:
        """False once the episode has ended."""
        return self._native.add()

    def write(self, path: str | os.PathLike[str], title: str = "") -> None:
        self._native.write(_check.path("path", path), str(title))
