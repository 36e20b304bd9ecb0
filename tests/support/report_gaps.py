"""report_gaps.py JUNIT FOLDER: says what CTest skipped, and why, by its JUnit report; and what the tests left in the folder that was their
TMPDIR. Fails where something was left, or skipped although KOBOSHI_SKIPS is "forbidden"."""

import collections
import os
import pathlib
import re
import sys
import xml.etree.ElementTree

# What is not here is a failure, which CTest reports itself.
SKIPS = re.compile("SKIP_RETURN_CODE|SKIP_REGULAR_EXPRESSION|Disabled")
REASONS = (re.compile(r"^skipped: (.+)$", re.MULTILINE),  # run_test.py, shell
           re.compile(r": Skipped\n(.+)$", re.MULTILINE))  # GTEST_SKIP


def skipped(report):
    """The tests by the reason for which they were."""
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
