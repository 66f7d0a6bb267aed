#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tools/include_graph.py [ROOT]: prints which folder includes which, from the bottom up. Exit code 1, and a line for
each, if folders or files include each other in a circle, or if what has to know no simulator reaches one, by whatever
way. What a folder may include stands in its CMakeLists.txt, under DEPENDS, and nothing else resolves."""

import argparse
import graphlib
import pathlib
import re
import sys

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


def folder_graph(includes):
    """The folders that each folder includes, without itself."""
    graph = {folder(file): set() for file in includes}
    for file, found in includes.items():
        graph[folder(file)].update({folder(other) for other in found} - {folder(file)})
    return graph


def circle(graph):
    """Members of a circle in `graph`, each includes the next; [] if there is none."""
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        return error.args[1][::-1]
    return []


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
    for graph in (includes, folder_graph(includes)):
        if found := circle(graph):
            yield f"a circle: {' -> '.join(found)}"
    for file in includes:
        if file.startswith(NO_SIMULATOR) and (way := way_to("sim/", file, includes)):
            yield f"{file}: reaches the simulator: {' -> '.join(way)}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("root", metavar="ROOT", nargs="?", type=pathlib.Path,
                        default=pathlib.Path(__file__).parent.parent)
    includes = read_includes(parser.parse_args().root)
    wrong = list(mistakes(includes))
    for line in wrong:
        print(f"include_graph.py: {line}", file=sys.stderr)
    if wrong:
        return 1
    graph = folder_graph(includes)
    for name in graphlib.TopologicalSorter(graph).static_order():
        print(f"{name} -> {' '.join(sorted(graph[name])) or 'nothing'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
