# SPDX-License-Identifier: BSD-3-Clause
"""The simulator without a task."""

import os
from typing import Any

import numpy as np

from . import _check, _native


class Batch:
    """Many robots on their ground, stepped in SIMD lanes and threads; a task of your own goes around it.

    batch = Batch(num_robots=64, ground="dry-sand")
    batch.targets[:] = batch.nominal_position_rad
    batch.advance(40)                    # 10 ms at 4 kHz
    batch.state["position"][:, 2]        # heights of the bases

    Structured arrays, a row for each robot (float32, SI units, world frame unless said):
    state    position, orientation (w, x, y, z), joint_position, velocity, angular_velocity (body frame),
             joint_velocity, contacts (4 feet), and the impulses from which the solver starts. Read-only:
             `set_state` writes
    drive    target, target_before and switch_tick (ticks of an `advance` after which `target` holds),
             kp, kd, torque_scale; of HAA, HFE, KFE: stall_torque_nm (0: no torque-speed line),
             inverse_no_load_speed, heat_factor (of a torque in sums). Write it: `advance` reads it
    report   of the latest tick: foot_velocity, penetration, foot_force
    sums     over the ticks of the latest `advance`: torque_squared, power, slip, foot_load, base_contact, ...

    robot, threads: as VectorEnv. ground, settings: as Ground, hard ground included.
    """

    def __init__(
        self,
        robot: str | os.PathLike[str] = "raibo",
        num_robots: int = 64,
        ground: str | os.PathLike[str] = "dry-sand",
        settings: _check.Settings = None,
        *,
        step_hz: float = 4000.0,
        threads: int = 1,
    ) -> None:
        self.num_robots = _check.integer("num_robots", num_robots, 1, 1 << 20)
        self._native = _native.Robots(
            robot=_check.path("robot", robot),
            count=self.num_robots,
            ground=_check.path("ground", ground),
            settings=_check.settings_lines(settings),
            step_hz=_check.number("step_hz", step_hz),
            threads=_check.integer("threads", threads, 1, 256),
        )
        self.drive = self._native.drives()
        self.targets = self.drive["target"]
        self.state, self.report, self.sums = self._native.states(), self._native.reports(), self._native.sums()
        for array in (self.state, self.report, self.sums):
            array.flags.writeable = False

    def __repr__(self) -> str:
        return f"Batch({self._native.robot_name!r}, num_robots={self.num_robots})"

    @property
    def nominal_position_rad(self) -> np.ndarray:
        return np.array(self._native.nominal_rad)

    @property
    def model(self) -> np.ndarray:
        """A copy of all masses, lengths and limits; `set_model` writes it back."""
        return self._native.models()

    def advance(self, ticks: int) -> None:
        """Makes `ticks` steps of 1/step_hz, with the drives as they are."""
        self._native.advance(_check.integer("ticks", ticks, 1, 1_000_000))

    def set_state(self, state: np.ndarray, robots: Any = None) -> None:
        """Rows like those of `state`, for these robots (indices; None: all)."""
        self._native.set_states(state, self._robots(robots))

    def set_model(self, model: np.ndarray, robots: Any = None) -> None:
        """Rows like those of `model`."""
        self._native.set_models(model, self._robots(robots))

    def set_ground(
        self, ground: str | os.PathLike[str], settings: _check.Settings = None, robots: Any = None
    ) -> None:
        """Puts robots on other ground; their feet forget the old one."""
        self._native.set_ground(_check.path("ground", ground), _check.settings_lines(settings), self._robots(robots))

    def stand(self, robots: Any = None) -> None:
        """Puts robots into their nominal pose, at rest, as after the construction."""
        self._native.stand(self._robots(robots))

    def _robots(self, robots: Any) -> list[int]:
        return _check.indices("robots", robots, self.num_robots)
