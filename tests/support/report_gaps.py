"""report_gaps.py JUNIT FOLDER: lists the skipped tests with their reasons, from CTest's JUnit report, and the files that tests left in
FOLDER, their TMPDIR. Fails if any file was left, or if a test was skipped and KOBOSHI_SKIPS is "forbidden"."""

import collections
import os
import pathlib
import re
import sys
import xml.etree.ElementTree

# All other reasons are failures, which CTest reports.
SKIPS = re.compile("SKIP_RETURN_CODE|SKIP_REGULAR_EXPRESSION|Disabled")
REASONS = (re.compile(r"^skipped: (.+)$", re.MULTILINE),  # run_test.py, shell
           re.compile(r": Skipped\n(.+)$", re.MULTILINE))  # GTEST_SKIP


def skipped(report):
    """Returns the skipped tests grouped by reason."""
    tests = collections.defaultdict(list)
    for case in xml.etree.ElementTree.parse(report).iter("testcase"):
        mark = case.find("skipped")
        name = case.get("name").partition("  # GetParam()")[0]
        if case.get("status") == "disabled":
            tests["disabled"].append(name)
        elif mark is not None and SKIPS.search(mark.get("message")):
            output = case.findtext("system-out") or ""
            reasons = dict.fromkeys(reason for pattern in REASONS for reason in pattern.findall(output))
            tests["; ".join(reasons) or "no reason given"].append(name)
    return tests


def main():
    report, folder = sys.argv[1:]
    skips = skipped(report)
    left = sorted(pathlib.Path(folder).iterdir())
    for reason, tests in skips.items():
        print(f"Skipped: {', '.join(tests)}: {reason}")
    for path in left:
        print(f"Left behind: {path}")
    forbidden = skips and os.environ.get("KOBOSHI_SKIPS") == "forbidden"
    if forbidden:
        print("Tests were skipped, and none may be")
    if left:
        print("Tests remove what they write")
    sys.exit(bool(forbidden or left))


main()
