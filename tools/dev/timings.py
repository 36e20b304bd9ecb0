#!/usr/bin/env python3
"""Prints where the time of a build and of its tests goes: build time by target and by header, test time by case.

Usage: tools/dev/timings.py [--build FOLDER] [--rows N] [build] [headers] [tests]

  build    seconds of each target's compilations and links, from the log of the last complete build (ninja's .ninja_log)
  headers  for each header of the project and each library header that it names, included by at least two translation
           units: seconds to compile the header alone, times the number of those units; takes some minutes
  tests    seconds of each test case and each suite, from the report of the last `./run test`

Without a subject it prints all three. Seconds are wall-clock seconds of one process each: on an idle machine their sum is
about the processor time. Compare figures of one machine only.
"""

import argparse
import collections
import concurrent.futures
import functools
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
OURS = ("base/", "mechanics/", "hal/", "firmware/", "sim_board/", "simulation/", "bus/", "view/", "tools/", "lab/", "studio/", "cli/", "tests/")


def table(title, columns, rows, shown):
    """Prints the first rows of a table as Markdown."""
    print(f"\n## {title}\n")
    print("| " + " | ".join(columns) + " |")
    print("|" + " --- |" * len(columns))
    for row in rows[:shown]:
        print("| " + " | ".join(f"{cell:.1f}" if isinstance(cell, float) else str(cell) for cell in row) + " |")
    if len(rows) > shown:
        print(f"\n{len(rows) - shown} more rows.")


def ninja_log(build):
    """Seconds of each output's last command. Commands with several outputs count once."""
    seconds, commands = {}, {}
    for line in (build / ".ninja_log").read_text().splitlines()[1:]:
        begin, end, _, output, command = line.split("\t")
        commands[command] = output
        seconds[output] = (int(end) - int(begin)) / 1000
    return {output: seconds[output] for output in commands.values()}


def target_of(output):
    match = re.search(r"CMakeFiles/([^/]+)\.dir/", output)
    return match.group(1) if match else pathlib.PurePath(output).stem.removeprefix("lib")


def print_build(build, shown):
    targets = collections.Counter()
    steps = collections.Counter()
    log = ninja_log(build)
    for output, seconds in log.items():
        targets[target_of(output)] += seconds
        steps[target_of(output)] += 1
    rows = [(target, steps[target], seconds) for target, seconds in targets.most_common()]
    table(f"Build time by target: {sum(log.values()):.0f} s in {len(log)} steps", ("target", "steps", "seconds"), rows, shown)


def translation_units(build):
    """Each compile command of the build, by its output."""
    commands = json.loads((build / "compile_commands.json").read_text())
    return {re.search(r" -o (\S+)", entry["command"]).group(1): entry for entry in commands}


def included_headers(build):
    """For each output the headers that it read, as ninja recorded them."""
    text = subprocess.run(["ninja", "-C", build, "-t", "deps"], check=True, capture_output=True, text=True).stdout
    headers, output = {}, None
    for line in text.splitlines():
        if line.startswith("    "):
            path = os.path.normpath(build / line.strip())
            headers[output].add(path)
        elif line.strip():
            output = line.split(":")[0]
            headers[output] = set()
    return headers


def direct_library_headers():
    """Headers in angle brackets that the project's headers and sources name."""
    names = set()
    for path in ROOT.rglob("*.h"):
        if str(path.relative_to(ROOT)).startswith(OURS):
            names.update(re.findall(r"^#include <([^>]+)>", path.read_text(), re.MULTILINE))
    return names


def seconds_alone(include, command):
    """Seconds to compile a file that only includes this, with the options of that compile command; None if it does not compile."""
    words = shlex.split(command["command"])
    begin = next(i for i, word in enumerate(words) if re.search(r"(g|c)\+\+[\d.-]*$", word))
    options = []
    for i, word in enumerate(words[begin:], begin):
        if word == "-isystem":
            options += [word, words[i + 1]]
        elif word.startswith(("-I", "-D", "-std", "-m", "-f")):
            options.append(word)
    with tempfile.NamedTemporaryFile("w", suffix=".cc") as source:
        source.write(f"#include {include}\n")
        source.flush()
        begin_s = time.monotonic()
        result = subprocess.run([words[begin], *options, "-w", "-fsyntax-only", source.name], cwd=command["directory"],
                                capture_output=True, check=False)
        return time.monotonic() - begin_s if result.returncode == 0 else None


def users_of_headers(build, units):
    """For each header, as an include names it, the outputs whose compilation reads it."""
    libraries = collections.defaultdict(set)
    for name in direct_library_headers():
        libraries[os.path.basename(name)].add(name)

    @functools.cache
    def include_names(header):
        path = pathlib.PurePath(header)
        if path.is_relative_to(ROOT):
            own = str(path.relative_to(ROOT))
            return [f'"{own}"'] if own.startswith(OURS) else []
        return [f"<{name}>" for name in libraries.get(path.name, ()) if header.endswith("/" + name)]

    users = collections.defaultdict(list)
    for output, headers in included_headers(build).items():
        for header in headers if output in units else ():
            for name in include_names(header):
                users[name].append(output)
    return users


def print_headers(build, shown):
    units = translation_units(build)
    users = {name: outputs for name, outputs in users_of_headers(build, units).items() if len(outputs) > 1}
    rows = []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        alone = pool.map(lambda item: seconds_alone(item[0], units[item[1][0]]), users.items())
        for done, ((include, outputs), seconds) in enumerate(zip(users.items(), alone), 1):
            print(f"\rheader {done} of {len(users)}", end="", file=sys.stderr, flush=True)
            if seconds is not None:
                rows.append((include, len(outputs), seconds, len(outputs) * seconds))
    print(file=sys.stderr)
    rows.sort(key=lambda row: -row[-1])
    table("Build time by header", ("header", "units", "seconds alone", "units x seconds"), rows, shown)


def print_tests(build, shown):
    report = build / "tests.xml"
    if not report.is_file():
        sys.exit(f"timings: found no {report}, expected the report of the last `./run test`")
    cases = [(case.get("name").split(" ")[0], float(case.get("time"))) for case in xml.etree.ElementTree.parse(report).iter("testcase")]
    cases.sort(key=lambda case: -case[1])
    seconds, counts = collections.Counter(), collections.Counter()
    for name, time_s in cases:
        suite = re.sub(r"^[^.]*/", "", name).split(".")[0]
        seconds[suite] += time_s
        counts[suite] += 1
    table(f"Test time by case: {sum(seconds.values()):.0f} s in {len(cases)} cases", ("case", "seconds"), cases, shown)
    table("Test time by suite", ("suite", "cases", "seconds"),
          [(suite, counts[suite], time_s) for suite, time_s in seconds.most_common()], shown)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("subjects", nargs="*", metavar="SUBJECT", help="build, headers, tests; default: all three")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "release", metavar="FOLDER")
    parser.add_argument("--rows", type=int, default=25, metavar="N", help="rows of each table")
    arguments = parser.parse_args()
    printers = {"build": print_build, "headers": print_headers, "tests": print_tests}
    for subject in arguments.subjects:
        if subject not in printers:
            parser.error(f"found the subject '{subject}', expected build, headers or tests")
    build = arguments.build.resolve()
    if not (build / ".ninja_log").is_file():
        sys.exit(f"timings: found no .ninja_log in {build}, expected a build folder of ninja")
    for subject in arguments.subjects or printers:
        printers[subject](build, arguments.rows)


if __name__ == "__main__":
    main()
