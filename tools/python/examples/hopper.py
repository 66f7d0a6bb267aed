#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A simulator of your own on our ground: one-legged hoppers in numpy, a body on a sprung leg with a ball foot. All of
them hop at once, each on sand of another stiffness, and push off with the same spring. Prints how high and how often
each hops, how deep its foot gets, and what energy the sand takes."""

import numpy as np
from sandrunner import Ground

BODY_KG, FOOT_KG, GRAVITY = 4.0, 0.3, 9.81
SPRING, DAMPER, LENGTH = 3000.0, 12.0, 0.4  # of the leg: N/m, N s/m, m
PUSH = 0.045  # m by which the leg lengthens while it extends under load
STEP_S, SECONDS, STIFFNESS = 2.5e-4, 3.0, (1.0, 2.0, 5.0, 20.0)  # of the sand, MN/m^3


class Hopper:
    """Body and foot on a vertical line that moves on to fresh sand in the air."""

    def __init__(self, sigma_mnpm3: float) -> None:
        settings = {"terrain.sigma_flat_npm3": 1e6 * sigma_mnpm3, "terrain.sigma_cone_npm3": 0.5e6 * sigma_mnpm3}
        self.ground = Ground("dry-sand", settings, foot_radius_m=0.04)
        self.contacts = self.ground.contacts(1)
        # Heights and speeds of body and foot.
        self.x, self.height, self.speed = 0.0, np.array([0.1 + LENGTH, 0.1]), np.zeros(2)
        self.push = 0.0

    def step(self) -> tuple[float, float]:
        """The ground's force, N, and its power, W."""
        (body, foot), (body_speed, foot_speed) = self.height, self.speed
        position, velocity = np.array([[self.x, 0.0, foot]]), np.array([[0.0, 0.0, foot_speed]])
        normal = self.ground.step(self.contacts, position, velocity, STEP_S)["normal"][0]
        rate = body_speed - foot_speed
        if foot > 0.0:
            self.push, self.x = 0.0, self.x + 0.5 * STEP_S
        elif rate > 0.0 and body - foot < LENGTH - 0.02:
            self.push = PUSH
        leg = SPRING * (LENGTH + self.push - (body - foot)) - DAMPER * rate
        self.speed += STEP_S * (np.array([leg / BODY_KG, (normal - leg) / FOOT_KG]) - GRAVITY)
        self.height += STEP_S * self.speed
        return normal, normal * foot_speed


def hop(sigma_mnpm3: float) -> tuple[float, float, float, float]:
    """Clearance of the foot, mm; hops a second; depth, mm; energy that the sand takes of each hop, J."""
    hopper = Hopper(sigma_mnpm3)
    feet, forces, powers = [], [], []
    for _ in range(round(SECONDS / STEP_S)):
        force, power = hopper.step()
        feet.append(hopper.height[1])
        forces.append(force)
        powers.append(power)
    foot, air = np.array(feet), np.array(feet) > 0.002
    starts = np.flatnonzero(air[1:] & ~air[:-1])  # lift-offs
    ends = np.flatnonzero(~air[1:] & air[:-1])
    flights = [(a, min(ends[ends > a])) for a in starts if (ends > a).any()]
    clearance = float(np.mean([foot[a:b].max() for a, b in flights])) if flights else 0.0
    depth = float(-foot[len(foot) // 2 :].min())
    return 1e3 * clearance, len(flights) / SECONDS, 1e3 * depth, -float(np.sum(powers)) * STEP_S / max(len(flights), 1)


def main() -> None:
    print("sand, MN/m^3  clearance, mm  hops, 1/s  depth, mm  taken by the sand, J a hop")
    for sigma in STIFFNESS:
        clearance, hops, depth, taken = hop(sigma)
        print(f"{sigma:12.1f}  {clearance:13.1f}  {hops:9.2f}  {depth:9.1f}  {taken:26.2f}")


if __name__ == "__main__":
    main()
