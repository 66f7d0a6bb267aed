#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tools/include_graph.py [ROOT]: prints which folder includes which, from the bottom up. Exit code 1, and a line for
each, if an include points up or to a sibling, if files include each other in a circle, or if what has to know no
simulator reaches one, by whatever way."""

import argparse
import fnmatch
import graphlib
import pathlib
import re
import sys

# From the bottom up. A folder may include those of the lines below its own, not its siblings;
# "drivers/drives/*" are all folders in drivers/drives that no line names.
LAYERS = [
    ["rt/core"],
    ["rt/base"],
    ["rt/dds", "policy", "estimator", "drivers/can", "drivers/imu"],
    ["drivers/drives"],
    ["drivers/drives/*"],
    ["drivers/robot"],
    ["drivers/check", "drivers/*"],
    ["drivers"],
    ["sim/lanes"],
    ["sim/robot"],
    ["sim/ground"],
    ["sim/step"],
    ["sim/batch", "sim"],
    ["rt/loop"],
    ["rt/operator", "rt/realtime", "rt/telemetry", "rt/telemetry/mcap"],
    ["rt/telemetry/dds", "rt/telemetry/recording", "rt/report"],
    ["rt/telemetry/view"],
    ["rt/run"],
    ["rt"],
    ["tools/bench/mujoco", "tools/train/data", "tools/train/kernels"],
    ["tools/train/learner", "tools/train/task"],
    ["tools/train/model"],
    ["tools/evaluate", "tools/hil/emulated", "tools/study/simulated"],
    ["tools/study/experiments"],
    ["tools/bench", "tools/ctl", "tools/hil", "tools/policy", "tools/replay", "tools/study", "tools/train"],
    ["tools/python"],
]
# The loop, telemetry and report know a robot, never the simulator.
NO_SIMULATOR = ("drivers/", "rt/core/", "rt/loop/", "rt/operator/", "rt/realtime/", "rt/report/", "rt/telemetry/")
TOP_FOLDERS = ("rt", "drivers", "policy", "estimator", "sim", "tools")


def folder(file):
    return file.rpartition("/")[0]


def read_includes(root):
    """The files of each file's #include "...", as far as they are files of the tree; paths from the root."""
    includes = {}
    for top in TOP_FOLDERS:
        for path in sorted((root / top).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                found = re.findall(r'^\s*#\s*include\s*"([^"]+)"', path.read_text(), re.MULTILINE)
                includes[path.relative_to(root).as_posix()] = [f for f in found if (root / f).is_file()]
    return includes


def layers(includes):
    """LAYERS with each pattern replaced by the folders of the tree that it matches."""
    named = {name for layer in LAYERS for name in layer}
    folders = sorted({folder(file) for file in includes} - named)

    def matches(pattern):
        return [f for f in fnmatch.filter(folders, pattern) if f.count("/") == pattern.count("/")]
    return [[f for name in layer for f in (matches(name) if "*" in name else [name])] for layer in LAYERS]


def way_to(target, start, includes):
    """The shortest chain of includes from `start` to a file whose path begins with `target`; None if there is none."""
    ways, seen = [[start]], {start}
    for way in ways:
        if way[-1].startswith(target):
            return way
        for file in includes.get(way[-1], []):
            if file not in seen:
                seen.add(file)
                ways.append(way + [file])
    return None


def mistakes(includes):
    level = {name: i for i, layer in enumerate(layers(includes)) for name in layer}
    for name in sorted({folder(file) for file in includes} - level.keys()):
        yield f"{name}: a folder that is not among LAYERS of tools/include_graph.py"
    for file, found in includes.items():
        for other in found:
            here, there = folder(file), folder(other)
            if here != there and level.get(there, len(LAYERS)) >= level.get(here, len(LAYERS)):
                yield f"{file}: includes {other}, which does not lie below it"
        if file.startswith(NO_SIMULATOR) and (way := way_to("sim/", file, includes)):
            yield f"{file}: reaches the simulator: {' -> '.join(way)}"
    try:
        graphlib.TopologicalSorter(includes).prepare()
    except graphlib.CycleError as error:
        yield f"a circle: {' -> '.join(reversed(error.args[1]))}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("root", metavar="ROOT", nargs="?", type=pathlib.Path,
                        default=pathlib.Path(__file__).parent.parent)
    root = parser.parse_args().root
    includes = read_includes(root)
    for layer in layers(includes):
        for name in layer:
            used = {folder(f) for file, found in includes.items() if folder(file) == name for f in found} - {name}
            print(f"{name} -> {' '.join(sorted(used)) or 'nothing'}")
    wrong = list(mistakes(includes))
    for line in wrong:
        print(f"include_graph.py: {line}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
