# SPDX-License-Identifier: BSD-3-Clause
"""The contact law of a foot on yielding ground, for a simulator of your own."""

import os

import numpy as np

from . import _check, _native


class Ground:
    """Force of the ground on feet, from where their deepest points are and how they move.

    The undisturbed ground is the plane z = 0. The law remembers each contact: give the same array of
    contacts to each step.

    ground   a preset ("dry-sand", "wet-sand", "grass", ...: terrain_preset_names()) or a terrain file
             (sim/ground/presets/README.md); it has to yield
    settings of the table [terrain]: {"terrain.sigma_flat_npm3": 0.7e6}
    foot_radius_m, foot_width_m: of a tyre that lies on its side; a width of 0: a ball
    foot_length_m, foot_width_m: of a flat sole; a length of 0: a tyre or ball
    foot_patches: of each foot, all of them "feet" below, each with an equal share of the force
    """

    def __init__(
        self,
        ground: str | os.PathLike[str] = "dry-sand",
        settings: _check.Settings = None,
        *,
        foot_radius_m: float = 0.0295,
        foot_width_m: float = 0.0,
        foot_length_m: float = 0.0,
        foot_patches: int = 1,
    ) -> None:
        self._native = _native.Feet(
            ground=_check.path("ground", ground),
            settings=_check.settings_lines(settings),
            foot_radius_m=_check.number("foot_radius_m", foot_radius_m),
            foot_width_m=_check.number("foot_width_m", foot_width_m),
            foot_length_m=_check.number("foot_length_m", foot_length_m),
            foot_patches=_check.integer("foot_patches", foot_patches, 1, 64),
        )

    @staticmethod
    def contacts(feet: int) -> np.ndarray:
        """Memories of `feet` feet in the air: a structured array."""
        return _native.contacts(_check.integer("feet", feet, 1, 1 << 24))

    def step(self, contacts: np.ndarray, position: np.ndarray, velocity: np.ndarray, step_s: float) -> np.ndarray:
        """One time step. `position`, `velocity`: (feet, 3), float64, of the deepest point of each foot, m and
        m/s. Changes `contacts`. Returns a structured array: `normal` (N, upwards; below 0 mud holds the foot
        back), `friction_bound` (N, the largest tangential force that your contact solver may find), `stroke`
        (feet, 2) (N, of the crater's wall, to be added as it is), `raw` (N, `normal` before its filter)."""
        if not isinstance(contacts, np.ndarray):
            raise ValueError(f"contacts: found {_check.shown(contacts)}, expected those of Ground.contacts()")
        return self._native.step(contacts, position, velocity, _check.number("step_s", step_s))
