#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""check.py MODEL [--mistakes | --mistake NAME]: explores a model (NAME.pml) completely with the model checker spin.

Every assertion and every claim (ltl) of the model must hold, in each of its sizes, and every step of it must be
reachable. With --mistakes each macro of a mistake changes the model, and spin must find the property that the model
names for it violated. Exit codes: 0 as expected, 1 not so, 77 skipped because spin is not installed.

A model lists its sizes and mistakes in comments:
    // size MACRO=VALUE
    // mistake NAME: PROPERTY      an assertion's variable, a claim, or "invalid end state"
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

MAX_DEPTH = 200_000
MEGABYTES = 2000


def fail(text):
    print(f"check.py: {text}", file=sys.stderr)
    sys.exit(1)


class Verdict:
    """What one run of the checker found."""

    def __init__(self, text, seconds):
        self.text, self.seconds = text, seconds
        self.complete = "error: max search depth too small" not in text and "Search not completed" not in text
        errors = re.search(r"errors: (\d+)", text)
        self.errors = int(errors[1]) if errors else None
        states = re.search(r"(\d+) states, stored", text)
        self.states = int(states[1]) if states else 0
        self.violated = (re.search(r"^pan:\d+: (.*?) \(at depth", text, re.MULTILINE) or [None, ""])[1]

    def unreached(self):
        """Steps that no execution takes, apart from the ends of processes that run for ever."""
        for process, steps in re.findall(r"unreached in (proctype \w+)\n((?:\t.*\n)*)", self.text):
            for line in re.findall(r"\t(.*:\d+, state .*)", steps):
                if '"-end-"' not in line:
                    yield f"{process}: {line}"


class Checker:
    """Builds the checker of one model, with one macro or none, and runs it."""

    def __init__(self, model, macro, folder):
        self.folder = folder
        self.folder.mkdir()
        self._run("spin", *([f"-D{macro}"] if macro else []), "-a", model)

    def _run(self, *words):
        done = subprocess.run([str(w) for w in words], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True)
        if done.returncode:
            fail(f"{' '.join(str(w) for w in words)}: exit code {done.returncode}\n{done.stdout}")
        return done.stdout

    def check(self, claim=None):
        """Assertions and end states, or one claim."""
        program = self.folder / ("assertions" if claim is None else "claims")
        flags = ["-DSAFETY", "-DNOCLAIM"] if claim is None else []
        if not program.exists():
            self._run("gcc", "-O0", "-w", *flags, f"-DMEMLIM={MEGABYTES}", "-o", program, "pan.c")
        options = [f"-m{MAX_DEPTH}", "-w20"] + ([] if claim is None else ["-a", "-N", claim])
        begin = time.monotonic()
        return Verdict(self._run(program, *options), time.monotonic() - begin)


def main():
    parser = argparse.ArgumentParser(formatter_class=argparse.RawDescriptionHelpFormatter, description=__doc__)
    parser.add_argument("model", metavar="MODEL", type=pathlib.Path)
    parser.add_argument("--mistakes", action="store_true")
    parser.add_argument("--mistake", metavar="NAME")
    options = parser.parse_args()
    for program in ("spin", "gcc"):
        if not shutil.which(program):
            print(f"skipped: found no {program}: tools/install_packages.sh test")
            sys.exit(77)
    model = options.model.resolve()
    text = model.read_text()
    claims = re.findall(r"(?m)^ltl (\w+)", text)
    sizes = re.findall(r"(?m)^// size (\S+)", text) or [None]
    mistakes = dict(re.findall(r"(?m)^// mistake (\w+): (.*)", text))

    with tempfile.TemporaryDirectory() as name:
        if options.mistakes or options.mistake:
            if options.mistake and options.mistake not in mistakes:
                fail(f"--mistake: found {options.mistake}, expected one of {', '.join(mistakes)}")
            for mistake in [options.mistake] if options.mistake else mistakes:
                expected = mistakes[mistake]
                claim = expected if expected in claims else None
                checker = Checker(model, mistake, pathlib.Path(name) / mistake)
                verdict = checker.check(claim)
                pattern = "acceptance cycle" if claim else rf"\b{expected}\b"
                if not re.search(pattern, verdict.violated):
                    print(verdict.text)
                    fail(f"{model.name} with {mistake}: found {verdict.violated or 'no error'}, "
                         f"expected a violation of {expected}")
                print(f"{model.stem} with {mistake}: {expected} is violated, as expected", flush=True)
            return

        print(f"{'model':14} {'size':12} {'property':16} {'states':>8} {'seconds':>8}")
        for size in sizes:
            checker = Checker(model, size, pathlib.Path(name) / (size or "all"))
            for claim in [None, *claims]:
                verdict = checker.check(claim)
                print(f"{model.stem:14} {size or '':12} {claim or 'assertions':16} {verdict.states:8} "
                      f"{verdict.seconds:8.1f}", flush=True)
                if verdict.errors != 0 or not verdict.complete:
                    print(verdict.text)
                    fail(f"{model.name}: found {verdict.violated or 'a search that did not end'}, expected no error")
                unreached = list(verdict.unreached()) if claim is None else []
                if unreached:
                    fail(f"{model.name}: found steps that no execution takes:\n" + "\n".join(unreached))


if __name__ == "__main__":
    main()
