# SPDX-License-Identifier: BSD-3-Clause
"""/usr/bin/python3 tools/study/page OUT: makes claims.csv, report.html and figures/ from
OUT/results.json, which sandrunner-study writes before it runs this."""
import json
import logging
import os
import sys
from pathlib import Path

# With python3- before them, the Debian packages.
PACKAGES = ("numpy", "scipy", "sklearn", "matplotlib")

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[variable] = "1"  # sums in one order: the same pictures each time
# Without a home folder it warns of its cache.
logging.getLogger("matplotlib").setLevel(logging.ERROR)

sys.path.append(str(Path(__file__).resolve().parents[2]))  # tools/pictures.py


def make_page(out):
    import sklearn  # noqa: F401: not only once a picture needs it

    import claims
    import controls
    import evidence
    import report
    from files import write_whole
    try:
        found, results = evidence.load(out / "results.json")
    except ValueError:
        raise OSError(f"{out}/results.json: found something else, expected what this version of sandrunner-study "
                      "writes") from None
    judged = claims.judge_all(found)
    (out / "figures").mkdir(exist_ok=True)
    write_whole(out / "claims.csv", claims.claims_csv(judged).encode())
    control = controls.made_of(found, results)
    if control:
        write_whole(out / "control.json", (json.dumps(control, indent=1) + "\n").encode())
    write_whole(out / "report.html", report.report_html(out / "figures", results, found, judged).encode())
    print(f"wrote {out}/report.html")


def main():
    if len(sys.argv) != 2 or sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        return 0 if len(sys.argv) == 2 else 2
    out = Path(sys.argv[1])
    try:
        if not (out / "results.json").is_file():
            raise OSError(f"{out}: found no results.json, expected the --out of sandrunner-study")
        make_page(out)
        sys.stdout.flush()
    except ModuleNotFoundError as error:
        packages = ", ".join("python3-" + name for name in PACKAGES)
        print(f"sandrunner-study: found no Python module {error.name}, expected those of the Debian packages {packages}; "
              f"{out}/results.json is complete: install them, then run /usr/bin/python3 {Path(__file__).parent} {out}",
              file=sys.stderr)
        return 2
    except OSError as error:
        print(f"sandrunner-study: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
