#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes cone.csv, static_depth.csv and drop.csv next to this script. Needs numpy (Debian: python3-numpy).

The granular law of one foot, written from its equations and sharing nothing with the simulator: Aguilar & Goldman's
developing cone as the paper generalises it (section S11), gated by the greatest depth so far, and the moving average of
the normal force (eq. S16). Constants are those of the paper's authors' code, whose foot is a tyre lying on its side with
r_h = 4 A/P. Depth z positive down, SI units; stress gradients in MN/m^3.
"""
import argparse
import pathlib

import numpy as np

argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()

FOLDER = pathlib.Path(__file__).parent
NU, THETA = 2.0, np.pi / 3.0  # recruitment rate, angle of the cone's side
K = NU / np.tan(THETA)
GROWTH = 2.7 * 0.57 * 1000.0 * NU  # c_g phi rho nu, kg/m^3: added mass per I_flat
DRAG = 17.2
TOLERANCE_M = 1e-4  # of the plastic memory
GRAVITY, MASS_KG, ROBOT_KG = 9.81, 5.0, 26.817
TYRE_RADIUS_M, TYRE_WIDTH_M = 0.0295, 0.025
PLACES = [(1, 0.15), (1, 0.6), (5, 0.4), (10, 0.15), (10, 0.6)]  # sigma_flat, sigma_cone


def tyre_radius(z):
    """r_h = 4 A/P of the patch 2 a(z) by the width, which the surface cuts out of the tyre."""
    a = np.sqrt(np.maximum(TYRE_RADIUS_M**2 - (TYRE_RADIUS_M - np.minimum(z, TYRE_RADIUS_M))**2, 0.0))
    return 4.0 * 2.0 * a * TYRE_WIDTH_M / (2.0 * (2.0 * a + TYRE_WIDTH_M))


class Cone:
    """Areas and integrals over the depth, by the midpoint rule in sqrt(z): the tyre's r_h goes with that root."""
    def __init__(self, radius):
        self.radius = radius
        s = np.linspace(0.0, np.sqrt(0.3), 400001)
        middle = (0.5 * (s[1:] + s[:-1]))**2
        step = np.diff(s**2)
        self.z = s**2
        self.flat = np.concatenate([[0.0], np.cumsum(self.flat_area(middle) * step)])
        self.cone = np.concatenate([[0.0], np.cumsum(self.cone_area(middle) * step)])

    def flat_area(self, z):
        return np.pi * np.maximum(self.radius(z) - K * z, 0.0)**2

    def cone_area(self, z):
        return (np.pi * self.radius(z)**2 - self.flat_area(z)) / np.cos(THETA)

    def flat_integral(self, z):
        return np.interp(z, self.z, self.flat)

    def cone_integral(self, z):
        return np.interp(z, self.z, self.cone)

    def force(self, z, place):
        return 1e6 * (place[0] * self.flat_integral(z) + place[1] * self.cone_integral(z))


def write(name, columns, rows):
    lines = [",".join(columns)] + [",".join(f"{value:.7g}" for value in row) for row in rows]
    (FOLDER / name).write_text("\n".join(lines) + "\n")


def constant(radius):
    return lambda z: np.full(np.shape(z), radius)


def cone_rows():
    buried = float(tyre_radius(TYRE_RADIUS_M))
    for radius, depths in [(0.0295, (.005, .01, .02, .1)), (buried, (.01, .1)), (0.0381, (.01,)),
                           (0.0, (.001, .002, .005, .01, .02, .03, .05, .1))]:
        cone = Cone(constant(radius) if radius else tyre_radius)
        for z in depths:
            yield [radius, z, float(cone.radius(z)), cone.flat_area(z), cone.cone_area(z), cone.flat_integral(z),
                   cone.cone_integral(z), cone.force(z, (1, .15)), cone.force(z, (1, .5)), cone.force(z, (10, .6)),
                   GROWTH * cone.flat_integral(z), DRAG * GROWTH * cone.flat_area(z)]


def static_rows(tyre):
    for force, places in [(MASS_KG * GRAVITY, PLACES), (ROBOT_KG * GRAVITY / 4.0, [(1, 0.15), (1, 0.2)])]:
        for place in places:
            low, high = 0.0, 0.3
            while high - low > 1e-8:
                middle = 0.5 * (low + high)
                low, high = (middle, high) if tyre.force(middle, place) < force else (low, middle)
            yield [*place, force, 1e3 * low]


def drop(tyre, place, height, inertia, filtered, dt):
    """Greatest depth and force, and the force's standard deviation over the last of 2 s, of 5 kg that fall on the foot,
    released with its centre at `height`. Semi-implicit Euler; the added mass takes the acceleration as the backward
    difference of the velocity."""
    depths = np.linspace(0.0, 0.2, 20001)
    quasistatic = tyre.force(depths, place)
    mass, drag = (x if inertia else 0.0 * depths
                  for x in (GROWTH * tyre.flat_integral(depths), DRAG * GROWTH * tyre.flat_area(depths)))
    steps = round(2.0 / dt)
    z, v, before = TYRE_RADIUS_M - height, 0.0, 0.0
    active, deepest, average, weight = False, 0.0, 0.0, 0.0
    forces = np.zeros(steps)
    greatest = 0.0
    for n in range(steps):
        if z < 0.0:
            active, average = False, 0.0
        else:
            if not active:
                active, deepest, average, weight = True, 0.0, 0.0, 0.0
            raw = 0.0
            if v > 0.0 and z >= deepest - TOLERANCE_M:
                i = min(int(z / 1e-5), 19999)
                part = z / 1e-5 - i
                f, m, d = (x[i] + part * (x[i + 1] - x[i]) for x in (quasistatic, mass, drag))
                raw = f + d * v * v + m * (v - before) / dt
            deepest = max(deepest, z)
            if filtered and v * before < 0.0:
                weight = min(weight + 100.0 * dt, 1.0)
            average = max((1.0 - 0.8 * weight) * raw + 0.8 * weight * average, 0.0)
        before = v
        forces[n] = average
        v += dt * (GRAVITY - average / MASS_KG)
        z += dt * v
        greatest = max(greatest, z)
    return [1e3 * greatest, forces.max(), forces[steps // 2:].std()]


def drop_rows(tyre):
    cases = [(place, height, inertia, 1, 0.25e-3) for place in PLACES for height in (0.05, 0.25) for inertia in (1, 0)]
    cases += [(place, 0.25, 1, 1, dt) for place in (PLACES[0], PLACES[2], PLACES[4]) for dt in (0.1e-3, 0.5e-3, 1e-3)]
    cases += [(place, 0.25, 1, 0, 0.25e-3) for place in (PLACES[0], PLACES[4])]
    for place, *rest in cases:
        yield [*place, *rest, *drop(tyre, place, *rest)]


tyre = Cone(tyre_radius)
write("cone.csv", ["constant_radius_m", "z_m", "radius_m", "flat_area_m2", "cone_area_m2", "flat_integral_m3",
                   "cone_integral_m3", "force_1_015_n", "force_1_05_n", "force_10_06_n", "added_mass_kg",
                   "drag_ns2pm2"], cone_rows())
write("static_depth.csv", ["sigma_flat_mnpm3", "sigma_cone_mnpm3", "force_n", "depth_mm"], static_rows(tyre))
write("drop.csv", ["sigma_flat_mnpm3", "sigma_cone_mnpm3", "centre_height_m", "inertia", "filter", "dt_s",
                   "max_depth_mm", "peak_force_n", "force_deviation_n"], drop_rows(tyre))
