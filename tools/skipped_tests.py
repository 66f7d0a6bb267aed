# SPDX-License-Identifier: BSD-3-Clause
"""skipped_tests.py RESULTS: the tests that did not run according to ctest's JUnit file, by the reason that each printed."""
import argparse
import re
import textwrap
import xml.etree.ElementTree as xml

# GoogleTest prints "FILE:LINE: Skipped" and the reason on the next line; scripts print "skipped:
# REASON".
REASON = re.compile(r"^\S+:\d+: Skipped\n(.+)|skipped: (.+)", re.MULTILINE | re.IGNORECASE)

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("results", metavar="RESULTS")
tests = {}
for case in xml.parse(parser.parse_args().results).iter("testcase"):
    if case.get("status") == "notrun":
        found = REASON.search(case.findtext("system-out") or "")
        reason = (found[1] or found[2]) if found else "it printed no reason"
        tests.setdefault(reason, []).append(case.get("name"))
if tests:
    print("\nSkipped tests:")
for reason, names in sorted(tests.items()):
    print(textwrap.fill(f"{reason}: {', '.join(names)}", 100, initial_indent="  ", subsequent_indent="    ",
                        break_long_words=False, break_on_hyphens=False))
