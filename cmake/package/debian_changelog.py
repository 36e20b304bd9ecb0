"""Prints the changelog of the Debian packages (deb-changelog(5)) from CHANGELOG.md: an entry for each release, with the
headings in brackets.

debian_changelog.py CHANGELOG.md VERSION SECONDS_SINCE_1970 MAINTAINER

The version and the date are those of the topmost release, which may be [Unreleased]; earlier ones bear their own."""

import datetime
import email.utils
import re
import sys
import textwrap

RELEASE = re.compile(r"## \[(?P<version>[^]]+)\](?: - (?P<date>\d{4}-\d\d-\d\d))?$")


def plain(markdown):
    """Returns the text without the marks of links, code and emphasis."""
    text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", markdown)
    return re.sub(r"`([^`]*)`", r"\1", text).replace("**", "")


def items(lines):
    """Returns the headings, as "[ Added ]", and the list items of a release, each on one line."""
    found = []
    for line in lines:
        if line.startswith("### "):
            found.append(f"[ {line[4:].strip()} ]")
        elif line.startswith("- "):
            found.append("* " + line[2:].strip())
        elif line.startswith("  ") and found:
            found[-1] += " " + line.strip()
    return [plain(item) for item in found]


def entry(version, date, maintainer, lines):
    text = f"koboshi ({version}) unstable; urgency=medium\n"
    for item in items(lines) or ["* First release."]:
        is_heading = item.startswith("[ ")
        indent = "  " if is_heading else "    "
        text += "\n" if is_heading else ""
        text += textwrap.fill(item, 78, initial_indent="  ", subsequent_indent=indent, break_long_words=False,
                              break_on_hyphens=False) + "\n"
    return text + f"\n -- {maintainer}  {email.utils.format_datetime(date)}\n"


def entries(text, version, date, maintainer):
    releases = []
    for line in text.splitlines():
        if heading := RELEASE.match(line):
            releases.append((heading, []))
        elif releases:
            releases[-1][1].append(line)
    for index, (heading, lines) in enumerate(releases):
        if index > 0:
            version = heading["version"]
            date = datetime.datetime.fromisoformat(heading["date"] + "T00:00:00+00:00")
        yield entry(version, date, maintainer, lines)


def main():
    file, version, seconds, maintainer = sys.argv[1:]
    with open(file, encoding="utf-8") as stream:
        text = stream.read()
    date = datetime.datetime.fromtimestamp(int(seconds), datetime.timezone.utc)
    sys.stdout.reconfigure(encoding="utf-8")
    print("\n".join(entries(text, version, date, maintainer)), end="")


if __name__ == "__main__":
    main()
