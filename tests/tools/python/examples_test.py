# SPDX-License-Identifier: BSD-3-Clause
"""The examples run, and so does the wheel, in an environment of its own without a compiler."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(os.environ["SANDRUNNER_ROOT"])
EXAMPLES = ROOT / "tools/python/examples"
PACKAGE = pathlib.Path(os.environ["PYTHONPATH"].split(":")[0], "sandrunner")

# tensorboard.summary.Writer as the package has it (2.20). A training writes a third row before the
# second flush, and Ctrl-C follows that one.
WRITER = """
import pathlib

class Writer:
    def __init__(self, folder):
        self.curve, self.flushes = pathlib.Path(folder).with_name("curve.csv"), 0
        print(folder)

    def add_scalar(self, tag, data, step):
        print(tag, data, step)

    def flush(self):
        self.flushes += 1
        if self.flushes == 2:
            raise KeyboardInterrupt
        self.curve.write_text(self.curve.read_text() + "3e+06,0.75\\n")
"""


def run(*words, **keywords):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=300, **keywords)
    if done.returncode:
        raise AssertionError(f"{words}: {done.stdout}{done.stderr}")
    return done.stdout


class Examples(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_look_writes_an_episode_of_the_shipped_policy_as_a_page(self):
        page = self.folder / "run.html"
        self.assertIn(": 1.00 s, no fall", run(sys.executable, EXAMPLES / "look.py", "--out", page, "--seconds", "1"))
        self.assertIn("<html", page.read_text()[:2000].lower())

    def test_hopper_hops_and_sinks_less_on_stiffer_sand(self):
        rows = [line.split() for line in run(sys.executable, EXAMPLES / "hopper.py").splitlines()[1:]]
        clearances, depths, taken = ([float(row[i]) for row in rows] for i in (1, 3, 4))
        self.assertEqual(depths, sorted(depths, reverse=True))
        self.assertEqual(taken, sorted(taken, reverse=True))
        self.assertGreater(min(clearances), 20.0)

    def test_a_curve_is_copied_to_tensorboard_and_followed(self):
        module, training = self.folder / "tensorboard", self.folder / "training"
        for folder in (module, training):
            folder.mkdir()
        (module / "__init__.py").touch()
        (module / "summary.py").write_text(WRITER)
        (training / "curve.csv").write_text("transitions,battery_alive\n1e+06,0.25\n2e+06,nan\n")
        out = run(sys.executable, EXAMPLES / "curve_to_tensorboard.py", training,
                  env={**os.environ, "PYTHONPATH": str(self.folder)})
        self.assertEqual(out.splitlines(), [
            str(training / "tensorboard"),
            "transitions 1000000.0 1000000", "battery_alive 0.25 1000000",
            "transitions 2000000.0 2000000", "battery_alive nan 2000000",
            "transitions 3000000.0 3000000", "battery_alive 0.75 3000000"])

    def test_a_wheel_runs_look_in_a_fresh_environment(self):
        wheel = run("/usr/bin/python3", ROOT / "tools/python/make_wheel.py", PACKAGE, "0.1.0", self.folder).strip()
        # numpy is the system's: nothing is downloaded.
        run("/usr/bin/python3", "-m", "venv", "--system-site-packages", self.folder / "venv")
        clean = {"PATH": f"{self.folder}/venv/bin", "HOME": str(self.folder)}
        run(self.folder / "venv/bin/pip", "install", "--no-index", "--no-deps", wheel, env=clean)
        python = self.folder / "venv/bin/python"
        page = self.folder / "run.html"
        run(python, EXAMPLES / "look.py", "--out", page, "--seconds", "0.5", cwd=self.folder, env=clean)
        self.assertGreater(page.stat().st_size, 100_000)
        maps = "import sandrunner, pathlib; print(pathlib.Path('/proc/self/maps').read_text())"
        loaded = run(python, "-c", maps, cwd=self.folder, env=clean)
        libraries = {line.split()[-1] for line in loaded.splitlines() if "libfmt" in line}
        (library,) = libraries
        self.assertRegex(library, "^" + re.escape(str(self.folder)) + ".*/sandrunner/lib/libfmt")

    def expect_policy_of(self, example, printed, *words):
        """That this example prints this and writes a policy file."""
        policy = self.folder / "walk.safetensors"
        words = ["--out", policy, *words, "--num-envs", 64, "--threads", 1]
        self.assertIn(printed, run(sys.executable, EXAMPLES / example, *words))
        run(sys.executable, "-c", f"from sandrunner import read_policy; read_policy({str(policy)!r})")

    def test_ppo_learns_for_an_update_and_writes_its_policy(self):
        try:
            import torch  # noqa: F401
        except ImportError:
            self.skipTest("PyTorch is not installed (Debian: python3-torch)")
        self.expect_policy_of("ppo.py", "0.00 M transitions", "--transitions", 2048)

    def test_rsl_rl_learns_for_an_iteration_and_writes_its_policy(self):
        try:
            import rsl_rl.runners  # noqa: F401
        except ImportError:
            self.skipTest("rsl_rl is not installed (pip install rsl-rl-lib)")
        self.expect_policy_of("rsl_rl_ppo.py", "falls in 4 s", "--iterations", 1)


if __name__ == "__main__":
    unittest.main()
