#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/tools/pictures_test.py SCRIPT: what tools/pictures.py makes of small files, and its refusals."""
import contextlib
import io
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

try:
    import matplotlib.pyplot as plt
except ModuleNotFoundError:
    print("skipped: no python3-matplotlib")
    sys.exit(77)

SCRIPT = pathlib.Path(sys.argv.pop(1)).resolve()
sys.path.append(str(SCRIPT.parent))
import pictures as script  # noqa: E402: its folder is an argument
LEGS = ("LF", "RF", "LH", "RH")
CURVE = ("transitions battery_alive battery_alive_5 battery_error battery_cost_of_transport battery_too_fast late_penalties "
         "settled reward kernel_rigid kernel_soil falls_rigid_per_4s falls_soil_per_4s stride_hz diagonal abreast "
         "command_speed_mps ground_open estimate_vx_rms_mps estimate_height_rms_m").split()


def csv_text(rows):
    return "\n".join([",".join(rows[0]), *(",".join(str(v) for v in row.values()) for row in rows)]) + "\n"


def run_rows(truth=True):
    """A robot that stands for 0.5 s, walks for 2 s and stands again; its feet sink in by 50 mm."""
    unknown = math.nan
    for i in range(300):
        t, walks = 0.01 * i, 50 <= i < 250
        row = {"t_s": t, "mode": "walk" if walks else "stand"}
        row |= {f"command_{name}": float(walks and name == "vx_mps") for name in ("vx_mps", "vy_mps", "wz_radps")}
        row |= {"base_x_m": t, "base_y_m": 0, "base_z_m": 0.45}
        row |= {f"orientation_{name}": int(name == "w") for name in "wxyz"}
        row |= {"vx_mps": 1 + math.sin(t) if truth else unknown, "vy_mps": math.sin(2 * t), "yaw_rate_radps": 0}
        for leg in LEGS:
            row |= {f"{leg}_{joint}_torque_nm": 20 * math.sin(9 * t) for joint in ("HAA", "HFE", "KFE")}
        for leg, x, y in zip(LEGS, (0.3, 0.3, -0.3, -0.3), (0.15, -0.15, 0.15, -0.15)):
            for end, z in (("hip", 0.45), ("knee", 0.2), ("foot", 0)):
                row |= {f"{leg}_{end}_x_m": t + x, f"{leg}_{end}_y_m": y, f"{leg}_{end}_z_m": z}
            row |= {f"{leg}_penetration_m": 0.05 if truth else unknown, f"{leg}_ground_height_m": 0}
            row |= {f"{leg}_stance_x_m": round(t, 1) + x, f"{leg}_stance_y_m": y, f"{leg}_stance_depth_m": 0.05}
        for what in ("truth", "estimate"):
            row |= {f"{what}_{name}": math.sin(t) if truth else unknown for name in ("body_height_m", "velocity_x_mps")}
        yield row


def evaluation_rows(scenarios, keys, **values):
    """A row of each policy for each of `scenarios`, dictionaries of columns; a figure is empty in the first."""
    for i, columns in enumerate(scenarios):
        for policy in ("a", '"b, the second"'):
            yield {"policy": policy, "ground": "dry-sand", "scenario": "", "command_vx_mps": 0, "command_vy_mps": 0,
                   "command_wz_radps": 0, "sigma_flat_npm3": 0, "sigma_cone_npm3": 0, "runs": 4, **columns,
                   **{key: values.get(key, 0.1 * i if i else "") for key in keys}}


class Pictures(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def draw(self, *words):
        """Exit code, output and errors of the script."""
        out, errors = io.StringIO(), io.StringIO()
        with (contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors),
              mock.patch("sys.argv", ["pictures.py", *(words or [str(self.folder)])])):
            return script.main(), out.getvalue(), errors.getvalue()

    def drawn(self, **files):
        """The pictures that the script makes of these files, by name."""
        for name, rows in files.items():
            (self.folder / f"{name}.csv").write_text(csv_text(list(rows)))
        code, output, errors = self.draw()
        self.assertEqual((code, errors), (0, ""))
        return {pathlib.Path(line.removeprefix("wrote ")).name: plt.imread(line.removeprefix("wrote "))
                for line in output.splitlines()}

    def refusal(self, name, text):
        (self.folder / name).write_text(text)
        code, output, errors = self.draw()
        self.assertEqual((code, output, errors.count("\n")), (2, "", 1), errors)
        return errors

    def pixels(self, picture, color):
        """How many have this colour, as #rrggbb."""
        wanted = [int(color[k:k + 2], 16) / 255 for k in (1, 3, 5)]
        return int((abs(picture[..., :3] - wanted).max(axis=2) < 0.02).sum())

    def test_a_run_has_its_charts_and_side_views_with_footprints(self):
        (self.folder / "summary.json").write_text('{"terrain": "dry-sand", "policy": null}')
        pictures = self.drawn(run=run_rows())
        self.assertEqual(sorted(pictures), ["run.png", "strip.png"])
        # vx, vy, two legs, the estimate.
        for color in ("#1f6bbf", "#0d9980", "#99c9f7", "#b84d05", "#e6730d"):
            self.assertGreater(self.pixels(pictures["run.png"], color), 100, color)
        for color in ("#ed8521", "#1a3354", "#7899bd"):  # body, right legs, left legs
            self.assertGreater(self.pixels(pictures["strip.png"], color), 5000, color)
        flat = [{**row, **{f"{leg}_stance_depth_m": 0.011 for leg in LEGS}} for row in run_rows()]
        sand = self.pixels(pictures["strip.png"], "#e6cc99")
        self.assertLess(sand, self.pixels(self.drawn(run=flat)["strip.png"], "#e6cc99") - 10000)

    def test_without_ground_truth_there_is_no_side_view(self):
        self.assertEqual(list(self.drawn(run=run_rows(truth=False))), ["run.png"])

    def test_a_training_has_its_curve(self):
        curve = self.drawn(curve=[dict.fromkeys(CURVE, i) for i in range(3)])["curve.png"]
        self.assertGreater(self.pixels(curve, "#1f6bbf"), 1000)

    def test_an_evaluation_has_a_picture_of_each_part(self):
        commands = [{"scenario": plane, "command_vx_mps": x, other: y, "ground": ground}
                    for plane, other in (("vx by vy", "command_vy_mps"), ("vx by wz", "command_wz_radps"))
                    for ground in ("dry-sand", "rigid") for x in (0, 0.5, 1) for y in (-1, 0, 1)]
        files = {
            "straight": list(evaluation_rows([{"command_vx_mps": v, "ground": g} for g in ("dry-sand", "rigid")
                                              for v in (1, 2)], ("track_speed_mps", "track_end_speed_mps", "vx_mps", "cot"))),
            "grid": list(evaluation_rows([{"sigma_flat_npm3": 1e6 * x, "sigma_cone_npm3": 1e5 * y} for x in (1, 2)
                                          for y in (1, 2)],
                                         ("survival", "velocity_error_mps", "yaw_error_radps", "clearance_iqr_m"))),
            "commands": list(evaluation_rows(commands, ("survival",), survival=1.0))}
        pictures = self.drawn(**files)
        self.assertEqual(sorted(pictures), ["commands.png", "grid.png", "straight_cost.png", "straight_speed.png"])
        without = self.pixels(pictures["commands.png"], "#21262e")
        for part in ("straight", "grid"):
            (self.folder / f"{part}.csv").unlink()
        envelope = {"forward_mps": 0.9, "backward_mps": 0.1, "lateral_mps": 0.5, "yaw_radps": 0.5}
        (self.folder / "evaluation.json").write_text(json.dumps({"policies": [{"name": "a", "envelope": envelope}]}))
        self.assertGreater(self.pixels(self.drawn()["commands.png"], "#21262e"), without + 500)

    def test_refuses_what_it_cannot_draw_in_one_line(self):
        self.assertIn(f"{self.folder}: found none of its files, expected one of run.csv, ", self.refusal("other.csv", ""))
        self.assertIn("run.csv: found 0 rows, expected", self.refusal("run.csv", ""))
        self.assertIn("run.csv: found 1 rows, expected", self.refusal("run.csv", "t_s,mode\n0,walk\n"))
        self.assertIn("run.csv: found no column command_vx_mps", self.refusal("run.csv", "t_s,mode\n0,walk\n1,walk\n"))
        self.assertIn("run.csv:3: found 1 cells, expected 2", self.refusal("run.csv", "t_s,mode\n0,walk\n1"))
        self.assertIn("run.csv:2: t_s: found 'x', expected a number", self.refusal("run.csv", "t_s,mode\nx,walk\n"))
        (self.folder / "run.csv").write_text(csv_text(list(run_rows())))
        self.assertIn("summary.json: found something else", self.refusal("summary.json", "{"))
        self.assertEqual(self.draw("/nowhere")[0], 2)
        self.assertEqual(self.draw("one", "two")[0], 2)

    def test_says_what_to_install(self):
        code = (f"import runpy, sys; sys.modules['matplotlib'] = None; sys.argv[1:] = ['.']; "
                f"runpy.run_path({str(SCRIPT)!r}, run_name='__main__')")
        done = subprocess.run([sys.executable, "-B", "-c", code], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        self.assertIn("no Python module matplotlib, expected the Debian package python3-matplotlib", done.stderr)


if __name__ == "__main__":
    unittest.main()
