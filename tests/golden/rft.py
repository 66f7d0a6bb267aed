#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes rft.csv next to this script: stresses of resistive force theory on a plate, per zeta (plane) or xi (space) and
depth, at tilts beta and directions of motion gamma below the horizontal, toward +x. x along the motion, z up.

Plane: C. Li, T. Zhang, D. Goldman, Science 339 (2013), generic coefficients. Space: S. Agarwal, D. Goldman, K. Kamrin,
PNAS 120 (2023), polynomials in x1 = sin g, x2 = cos b, x3 = cos psi cos g sin b + sin g cos b; here psi = 0.
"""
import argparse
import pathlib
from math import cos, pi, sin

argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()


def plane(b, g):
    up = (.206 + .169 * cos(2 * b) + .212 * sin(2 * b + g) + .358 * sin(g) + .055 * sin(-2 * b + g))
    against = -.124 * cos(2 * b + g) + .253 * cos(g) + .007 * cos(-2 * b + g) + .088 * sin(2 * b)
    return -against, up


C1 = [.00212, -.02320, -.20890, -.43083, -.00259, .48872, -.00415, .07204, -.02750, -.08772,
      .01992, -.45961, .40799, -.10107, -.06576, .05664, -.09269, .01892, .01033, .15120]
C2 = [-.06796, -.10941, .04725, -.06914, -.05835, -.65880, -.11985, -.25739, -.26834, .02692,
      -.00736, .63758, .08997, .21069, .04748, .20406, .18519, .04934, .13527, -.33207]
C3 = [-.02634, -.03436, .45256, .00835, .02553, -1.31290, -.05532, .06790, -.16404, .02287,
      .02927, .95406, -.00131, -.11028, .01487, -.20770, .10911, -.04097, .07881, -.27519]


def space(b, g):
    x1, x2, x3 = sin(g), cos(b), cos(g) * sin(b) + sin(g) * cos(b)
    terms = [1, x1, x2, x3, x1**2, x2**2, x3**2, x1 * x2, x2 * x3, x3 * x1, x1**3, x2**3, x3**3,
             x1 * x2**2, x2 * x1**2, x2 * x3**2, x3 * x2**2, x3 * x1**2, x1 * x3**2, x1 * x2 * x3]
    f1, f2, f3 = (sum(c * t for c, t in zip(coefficients, terms)) for coefficients in (C1, C2, C3))
    return f1 * sin(b) + f2 * cos(g), -f1 * cos(b) - f2 * sin(g) - f3


lines = ["dimensions,beta_rad,gamma_rad,x,z"]
for dimensions, alpha, angles in [
        (2, plane, [(0, pi / 2), (0, -pi / 2), (pi / 2, 0), (pi / 4, pi / 4), (pi / 6, pi / 2)]),
        (3, space, [(0, pi / 2), (pi / 2, 0), (pi / 4, pi / 4)])]:
    for b, g in angles:
        x, z = alpha(b, g)
        lines.append(f"{dimensions},{b:.17g},{g:.17g},{x:.9f},{z:.9f}")
(pathlib.Path(__file__).parent / "rft.csv").write_text("\n".join(lines) + "\n")
