#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Shows a training of sandrunner-train in TensorBoard, also while it runs: copies DIR/curve.csv into DIR/tensorboard,
every 5 s what is new, until Ctrl-C. Needs the package tensorboard (pip install tensorboard), but no PyTorch."""

import argparse
import csv
import pathlib
import time

from tensorboard.summary import Writer


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dir", type=pathlib.Path, help="folder of the training, its --out")
    folder = parser.parse_args().dir
    if not (folder / "curve.csv").exists():
        parser.error(f"{folder}: found no curve.csv, expected the folder of a training that has begun")
    writer, done = Writer(str(folder / "tensorboard")), 0
    while True:
        rows = list(csv.DictReader((folder / "curve.csv").read_text().splitlines()))
        for row in rows[done:]:
            for name, value in row.items():
                writer.add_scalar(name, float(value), int(float(row["transitions"])))
        writer.flush()
        done = len(rows)
        time.sleep(5.0)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
