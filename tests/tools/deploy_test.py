#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/tools/deploy_test.py BUILD VERSION: what tools/deploy installs and packs of the programs of VERSION in the build
folder BUILD."""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD, VERSION = sys.argv.pop(1), sys.argv.pop(1)


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False, **options)
    assert done.returncode == 0, done
    return done.stdout


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.prefix = pathlib.Path(folder.name)
        run("cmake", "--install", BUILD, "--prefix", cls.prefix)

    def test_every_program_runs_from_where_it_was_installed(self):
        programs = sorted(path.name for path in (self.prefix / "bin").iterdir())
        self.assertEqual(programs, ["sandrunner", "sandrunner-ctl", "sandrunner-policy", "sandrunner-replay"])
        for program in programs:
            self.assertIn(VERSION, run(self.prefix / "bin" / program, "--version"))

    def test_the_robot_runs_with_the_settings_of_the_example(self):
        settings = self.prefix / "share/doc/sandrunner/examples/settings.toml"
        with tempfile.TemporaryDirectory() as elsewhere:
            out = run(self.prefix / "bin/sandrunner", "--start", "walk", "--duration", "1", "--config", settings,
                      cwd=elsewhere)
        self.assertIn("state hash", out)

    @unittest.skipUnless(shutil.which("systemd-analyze"), "no systemd-analyze here")
    def test_systemd_finds_no_mistake_in_the_units(self):
        source = self.prefix / "lib/systemd/system"
        with tempfile.TemporaryDirectory() as folder:
            units = pathlib.Path(folder)
            for unit in source.iterdir():
                text = unit.read_text().replace("ExecStart=sandrunner", f"ExecStart={self.prefix}/bin/sandrunner")
                text = text.replace("=ip ", "=true ")
                (units / unit.name.replace("@", "@can0")).write_text(text.replace("User=sandrunner", "User=root"))
            drop_in = units / "sandrunner-can@can0.service.d"
            drop_in.mkdir()
            shutil.copy(self.prefix / "share/doc/sandrunner/examples/can-irq.conf", drop_in)
            verified = subprocess.run(
                ["systemd-analyze", "verify", "--man=no", units / "sandrunner.service",
                 units / "sandrunner-can@can0.service"], capture_output=True, text=True, check=False)
        self.assertEqual((verified.returncode, verified.stdout + verified.stderr), (0, ""))

    def test_the_service_never_arms_the_robot_and_has_no_watchdog_that_nobody_feeds(self):
        unit = (self.prefix / "lib/systemd/system/sandrunner.service").read_text()
        self.assertNotIn("--arm", unit)
        self.assertNotRegex(unit, "(?m)^WatchdogSec")

    def test_the_service_starts_again_until_its_devices_are_there(self):
        unit = (self.prefix / "lib/systemd/system/sandrunner.service").read_text()
        self.assertRegex(unit, "(?m)^Restart=on-failure$")
        self.assertRegex(unit, "(?m)^StartLimitIntervalSec=0$")
        self.assertNotRegex(unit, "(?m)^(RestartPreventExitStatus|StartLimitBurst)=")

    def test_a_walking_robot_has_the_time_to_lie_down(self):
        unit = (self.prefix / "lib/systemd/system/sandrunner.service").read_text()
        self.assertGreaterEqual(int(re.search("(?m)^TimeoutStopSec=([0-9]+)$", unit)[1]), 15)

    def test_a_crash_leaves_the_guards_the_time_to_damp_the_robot(self):
        unit = (self.prefix / "lib/systemd/system/sandrunner.service").read_text()
        self.assertRegex(unit, "(?m)^KillMode=control-group$")
        self.assertNotRegex(unit, "(?m)^(SendSIGKILL|FinalKillSignal|RestartKillSignal)=")

    def test_every_program_has_a_man_page_with_its_options_and_subcommands(self):
        for program in (self.prefix / "bin").iterdir():
            page = (self.prefix / f"share/man/man1/{program.name}.1").read_text()
            self.assertIn("--version", page.replace("\\", ""))
            for subcommand in re.findall(r"(?m)^  ([a-z-]+) ", run(program, "--help").partition("Subcommands:")[2]):
                if subcommand.startswith("sandrunner"):
                    continue  # an example
                self.assertIn(f"SUBCOMMAND {subcommand.upper()}", page.replace("\\", ""))

    def test_a_shell_completes_options_and_subcommands(self):
        for program in (self.prefix / "bin").iterdir():
            rules = self.prefix / "share/bash-completion/completions" / program.name
            said = run("bash", "-c", f"source {rules}; complete -p {program.name}")
            words = said.partition("'")[2].partition("'")[0].split()
            for line in run(program, "--help").splitlines():
                if found := re.match(r"  (?:-\w,)?(--[a-z-]+|(?!sandrunner)[a-z-]+ )", line):
                    self.assertIn(found[1].strip(), words)

    def test_documents_bring_what_they_refer_to(self):
        folder = self.prefix / "share/doc/sandrunner"
        documents = sorted(folder.rglob("*.md"))
        self.assertIn(folder / "drivers/robot/README.md", documents)
        scripts = r"tools/(?:dds_security\.sh|ros2_localhost\.(?:sh|xml))|rt/telemetry/foxglove_layout\.json"
        for document in documents:
            text = document.read_text()
            prose = re.sub(r"^( *)```.*?^\1```", "", text, flags=re.DOTALL | re.MULTILINE)
            for link in re.findall(r"\]\(([^)#:]+)\)", prose):
                self.assertTrue((document.parent / link).exists(), f"{document}: {link}")
            for path in re.findall(r"(?<![\w./-])((?:[\w-]+/)+(?:README|NOTES|CLAIMS)\.md|" + scripts + ")", text):
                self.assertTrue((folder / path).exists() or (document.parent / path).exists(), f"{document}: {path}")


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        run("cpack", "--config", pathlib.Path(BUILD, "CPackConfig.cmake"), "-B", folder.name)
        [cls.package] = pathlib.Path(folder.name).glob("*.deb")

    def field(self, name):
        return run("dpkg-deb", "--field", self.package, name).strip()

    def test_it_carries_the_version_of_the_project(self):
        self.assertEqual(self.package.name, f"sandrunner_{VERSION}_{run('dpkg', '--print-architecture').strip()}.deb")
        self.assertEqual(self.field("Version"), VERSION)

    def test_it_needs_libraries_at_run_time_only(self):
        packages = [re.match(r"\S+", need)[0] for need in self.field("Depends").split(", ")]
        self.assertTrue(any(name.startswith("libddsc0") for name in packages), packages)
        self.assertEqual([name for name in packages if not name.startswith(("lib", "zlib1g")) or "-dev" in name], [])

    def test_it_leaves_etc_to_the_administrator(self):
        paths = [line.split()[-1] for line in run("dpkg-deb", "--contents", self.package).splitlines()]
        self.assertIn("./usr/bin/sandrunner", paths)
        self.assertIn("./usr/lib/systemd/system/sandrunner.service", paths)
        self.assertEqual([path for path in paths if not path.startswith("./usr/")], [])

    def test_it_carries_man_pages_documents_and_the_scripts_that_they_name(self):
        paths = [line.split()[-1] for line in run("dpkg-deb", "--contents", self.package).splitlines()]
        for path in ("man/man1/sandrunner.1", "man/man1/sandrunner-ctl.1", "man/man1/sandrunner-policy.1",
                     "man/man1/sandrunner-replay.1", "doc/sandrunner/tools/deploy/README.md",
                     "doc/sandrunner/rt/README.md", "doc/sandrunner/tools/dds_security.sh",
                     "doc/sandrunner/tools/ros2_localhost.sh", "doc/sandrunner/copyright"):
            self.assertIn("./usr/share/" + path, paths)


if __name__ == "__main__":
    unittest.main()
