# SPDX-License-Identifier: BSD-3-Clause
"""The environments of sandrunner-train as a vector environment."""

import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from . import _check, _native

try:
    from gymnasium.spaces import Box
    from gymnasium.vector import VectorEnv as _Base
except ImportError:
    from .spaces import Box

    class _Base:  # type: ignore[no-redef]
        """What gymnasium's VectorEnv offers besides the methods below."""

        metadata: dict[str, Any] = {}

        @property
        def unwrapped(self) -> "_Base":
            return self


try:
    from gymnasium.vector import AutoresetMode

    _AUTORESET = AutoresetMode.SAME_STEP
except ImportError:
    _AUTORESET = "SameStep"

OBSERVATION_SIZE = 33
ACTION_SIZE = 12
_PROGRESS = ("speed_mps", "ground", "transitions", "late")
_NO_FRAMES = ("expected None: sandrunner.Recording (examples/look.py) writes an episode as a page, and "
              "tools/moving_picture.sh makes a moving picture of a run")


class VectorEnv(_Base):
    """Robots that learn to walk on randomised ground: 10 ms a step, episodes of 4 s, all in step.

    Arrays that `reset` and `step` return are views of the simulator's own memory: the next step
    overwrites them. Copy what you keep, or make the environment with `copy=True`.

    robot       "raibo", "go2", or the path of a robot file (sim/robot/README.md)
    num_envs    a multiple of the setting learner.block_envs, 64
    seed        of all that is drawn
    threads     worker threads; the bits do not depend on them
    settings    those of tools/train/training.toml: {"command.speed_start_mps": 1.0},
                ["command.speed_start_mps=1.0"], or the path of a TOML file
    curriculum  True: top speed, softness of the ground and the schedule of the reward move as in a
                training. False: they stay at its start. A dictionary of some of speed_mps, ground
                (0 to 1), transitions, late (0 to 1): they stay at these values
    actions     "joints": joint target = nominal position + action_scale_rad * action.
                "modes": the trainer's coordinates, in which a gait is found faster
                (tools/train/task/leg_modes.h); `write_policy` turns them into joints
    copy        whether arrays are copies
    width       robots that a core steps at once, 1, 8 or 16; 0: the most. The bits do not depend on it
    render_mode None: it draws no frames. `Recording` writes an episode as a page

    Raises ValueError, one line, for what cannot be used.
    """

    metadata: dict[str, Any] = {"autoreset_mode": _AUTORESET, "render_modes": []}
    render_mode: str | None = None
    spec = None
    closed = False

    def __init__(
        self,
        robot: str | os.PathLike[str] = "raibo",
        num_envs: int = 1024,
        seed: int = 1,
        threads: int = 1,
        settings: _check.Settings | os.PathLike[str] = None,
        curriculum: bool | Mapping[str, float] = True,
        *,
        actions: str = "joints",
        copy: bool = False,
        width: int = 0,
        render_mode: None = None,
    ) -> None:
        if render_mode is not None:
            raise ValueError(f"render_mode: found {_check.shown(render_mode)}, {_NO_FRAMES}")
        if not isinstance(actions, str) or actions not in ("joints", "modes"):
            raise ValueError(f"actions: found {_check.shown(actions)}, expected 'joints' or 'modes'")
        if not isinstance(curriculum, (bool, Mapping)):
            raise ValueError(f"curriculum: found {_check.shown(curriculum)}, expected True, False or a dictionary")
        config_file = ""
        if isinstance(settings, (str, os.PathLike)):
            config_file, settings = _check.path("settings", settings), None
        self._seed = _check.integer("seed", seed, 0, 2**63 - 1)
        self._native = _native.Environments(
            robot=_check.path("robot", robot),
            envs=_check.integer("num_envs", num_envs, 1, 1 << 20),
            seed=self._seed,
            threads=_check.integer("threads", threads, 1, 256),
            config_file=config_file,
            settings=_check.settings_lines(settings),
            in_joints=actions == "joints",
            width=_check.integer("width", width, 0, 16),
        )
        self.num_envs = int(num_envs)
        self.action_mode = actions
        self._copy = bool(copy)
        self._resets = 0  # without a seed, since the latest seed
        self._make_views()
        self._make_spaces()
        self._start = self._native.progress()
        if isinstance(curriculum, Mapping):
            self.set_curriculum(**_named_progress(curriculum))
            self._start = self._native.progress()
            self._native.restart(self._seed)
        self._native.set_moves(curriculum is True)

    def _make_views(self) -> None:
        views = self._native.arrays()
        flags = ("terminated", "truncated", "ended", "reset")
        self._views = {name: view.view(np.bool_) if name in flags else view for name, view in views.items()}
        names = _native.reward_term_names()
        terms = self._views.pop("reward_terms")
        self._terms = {name: terms[:, i] for i, name in enumerate(names)}

    def _make_spaces(self) -> None:
        n, clip = self.num_envs, self._native.observation_clip
        limit = self._native.action_clip if self.action_mode == "joints" else np.inf
        self.single_observation_space = Box(-clip, clip, (OBSERVATION_SIZE,), np.float32)
        self.observation_space = Box(-clip, clip, (n, OBSERVATION_SIZE), np.float32)
        self.single_action_space = Box(-limit, limit, (ACTION_SIZE,), np.float32)
        self.action_space = Box(-limit, limit, (n, ACTION_SIZE), np.float32)

    def _out(self, name: str) -> np.ndarray:
        return self._views[name].copy() if self._copy else self._views[name]

    def _info(self) -> dict[str, Any]:
        terms = {name: term.copy() for name, term in self._terms.items()} if self._copy else dict(self._terms)
        return {
            "privileged": self._out("privileged"),
            "estimate_target": self._out("estimate_target"),
            "reset": self._out("reset"),
            "reward_terms": terms,
            "final_obs": self._out("final_observation"),
            "_final_obs": self._out("ended"),
            "final_privileged": self._out("final_privileged"),
        }

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begins all episodes anew. With a seed: as a new environment of that seed, its curriculum included.
        Without: with other draws than before, which no other seed has, and the curriculum where it is; the first time,
        as it was made."""
        del options
        self._require_open()
        if seed is not None:
            self._seed = _check.integer("seed", seed, 0, 2**63 - 1)
            self._native.set_progress(**self._start)
            self._native.restart(self._seed)
            self._resets = 1
            return self._out("observation"), self._info()
        if self._resets > 0:
            # 63 bits of a hash: they meet neither another seed's nor a seed that is counted up.
            hashed = np.random.SeedSequence((self._seed, self._resets)).generate_state(1, np.uint64)[0]
            self._native.restart(int(hashed) >> 1)
        self._resets += 1
        return self._out("observation"), self._info()

    def step(
        self, actions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Advances all robots by 10 ms. `actions`: (num_envs, 12), float32. Where an episode ends, the next one
        begins within the same step: the observation is its first, info["final_obs"] the last of the old one.

        info: privileged (num_envs, 77), for a critic; estimate_target (num_envs, 8), what an estimator should
        answer; reset, where a recurrent policy has to clear its memory; reward_terms, by name; final_obs with
        its mask _final_obs; final_privileged, where an episode was truncated."""
        self._require_open()
        self._resets = max(self._resets, 1)
        self._native.step(actions)
        return (
            self._out("observation"),
            self._out("reward"),
            self._out("terminated"),
            self._out("truncated"),
            self._info(),
        )

    def __repr__(self) -> str:
        name = self._native.robot_name
        return f"VectorEnv({name!r}, num_envs={self.num_envs}, seed={self._seed}, actions={self.action_mode!r})"

    @property
    def step_dt(self) -> float:
        """Of a step, s; as rsl_rl and Isaac Lab call it."""
        return _native.step_s

    def render(self) -> None:
        """Raises NotImplementedError, one line: the only render_mode is None, which draws no frames."""
        raise NotImplementedError(f"VectorEnv: found a call of render(), {_NO_FRAMES}")

    def close(self, **kwargs: Any) -> None:
        """Ends the use of this environment. Arrays that it returned stay readable."""
        del kwargs
        self.closed = True

    def _require_open(self) -> None:
        if self.closed:
            raise ValueError("VectorEnv: found a call after close(), expected none")

    @property
    def curriculum(self) -> dict[str, float]:
        """speed_mps: top speed of the commands; ground: 0 to 1, how soft and uneven it may be; transitions so
        far; late: 0 to 1, share of the late penalties."""
        return self._native.progress()

    def set_curriculum(
        self,
        speed_mps: float | None = None,
        ground: float | None = None,
        transitions: float | None = None,
        late: float | None = None,
    ) -> None:
        """Moves the curriculum; None: stays. sandrunner-train raises `late` once the policy passes its tests."""
        given = {"speed_mps": speed_mps, "ground": ground, "transitions": transitions, "late": late}
        wanted = {
            name: old if given[name] is None else _check.number(f"curriculum: {name}", given[name])
            for name, old in self._native.progress().items()
        }
        self._native.set_progress(**wanted)

    @property
    def statistics(self) -> dict[str, float]:
        """Means of the latest window of `window_steps` steps: tracking, falls, gait, each term of the reward."""
        return self._native.statistics()

    @property
    def window_steps(self) -> int:
        """Steps after each of which the curriculum moves: learner.window."""
        return self._native.window_steps

    @property
    def action_scale_rad(self) -> float:
        return self._native.action_scale_rad

    @property
    def nominal_position_rad(self) -> np.ndarray:
        return np.array(self._native.nominal_rad)

    @property
    def joint_names(self) -> list[str]:
        """In the order of actions and observations."""
        return self._native.joint_names

    @property
    def max_episode_length(self) -> int:
        return round(self._native.episode_length_s / self.step_dt)

    @property
    def effective_settings(self) -> str:
        """TOML of all settings."""
        return self._native.effective_settings

    def raw_observation(self, observation: np.ndarray) -> np.ndarray:
        """In SI units, as the controller's policy is shown it (estimator/observation.h)."""
        scales = self._native.scales()
        return observation / scales["inverse_deviation"] + scales["mean"]

    def raw_estimate(self, estimate: np.ndarray) -> np.ndarray:
        """`estimate_target`, or what an estimator answers, in SI units (columns: README.md)."""
        scales = self._native.scales()
        return estimate * scales["estimate_deviation"] + scales["estimate_mean"]


def _named_progress(values: Mapping[str, float]) -> dict[str, float]:
    for name in values:
        if name not in _PROGRESS:
            raise ValueError(f"curriculum: found {_check.shown(name)}, expected one of {', '.join(_PROGRESS)}")
    return dict(values)
