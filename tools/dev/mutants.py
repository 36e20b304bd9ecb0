#!/usr/bin/env python3
"""Changes one place of the sources at a time, builds, and tells whether a test notices.

Usage: tools/dev/mutants.py [--count N] [--seed N] [--skip N] [--jobs N] [--at-least PERCENT] [--only REGEX]
                            [--programs REGEX] [--define NAME=VALUE]... [FOLDER...]

FOLDER (default: firmware) is a folder of the sources. If all are below hal/ or firmware/, the firmware preset and its unit
tests judge the mutants, else the release preset. They are built in copies of the versioned files below build/mutants, one for
each job, with --define as additional settings for CMake. The libraries of the folders are built without unity builds, all else
with them. The next run builds only what has changed since. With --programs, only the test programs with such names are built
and judge: a lower bound in less time. A mutant swaps an operator, changes a constant, fixes a condition, or drops a statement.

Each mutant is one of:
  killed      a test program that contains the changed code fails, crashes or takes ten times as long, or a static
              assertion fails
  survived    all of these programs pass
  equivalent  the optimised code is the same, or tests/proof/equivalent_mutants.txt names the mutant, with the reason
  invalid     it does not compile, or no program of the preset contains it

Mutants are drawn until --count of them are killed or have survived. The same sources, seed and folders give the same mutants
in the same order. --skip leaves out the first ones: the number of lines that an interrupted run has reported. The test program
with the most of the mutant's folder in its name judges first, then the others, by the time that they take. Each line of the
report is: verdict, file:line, the change, and what noticed. The exit status is 1 if fewer than --at-least percent (default 0)
were killed, 2 for bad arguments.
"""

import argparse
import concurrent.futures
import dataclasses
import hashlib
import json
import os
import pathlib
import queue
import re
import shutil
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
JUDGED = ROOT / "tests/proof/equivalent_mutants.txt"

TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)
      | (?P<text>R"\(.*?\)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+')
      | (?P<directive>^[ \t]*\#(?:[^\n]*\\\n)*[^\n]*)
      | (?P<number>(?<![\w'])\d(?:'?[\w.])*)
      | (?P<word>[A-Za-z_]\w*)
      | (?P<operator><=>|<<=|>>=|->|::|\+\+|--|&&|\|\||[-+*/%&|^<>=!]=|<<|>>|[-+*/%&|^<>=!~?:;,.(){}\[\]])""",
    re.VERBOSE | re.DOTALL | re.MULTILINE)

# The format of the sources puts blanks around binary operators, and none inside the brackets of templates or after a unary
# operator or a reference.
BINARY = {
    "<": ["<=", ">="], "<=": ["<", ">"], ">": [">=", "<="], ">=": [">", "<"], "==": ["!="], "!=": ["=="],
    "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"], "%": ["*"], "&&": ["||"], "||": ["&&"], "&": ["|"], "|": ["&"],
    "^": ["|"], "<<": [">>"], ">>": ["<<"], "+=": ["-=", "="], "-=": ["+=", "="], "*=": ["/="], "/=": ["*="],
    "|=": ["&=", "="], "&=": ["|="], "<<=": [">>="], ">>=": ["<<="],
}
WORDS = {"true": ["false"], "false": ["true"], "min": ["max"], "max": ["min"], "break": [""], "continue": [""]}
# Words that begin no statement that could be dropped without more.
NO_STATEMENT = set("""
  alignas auto bool case char class concept const constexpr consteval constinit default delete do double else enum explicit
  extern float for friend goto if inline int long namespace new operator private protected public requires return short
  signed static static_assert struct switch template throw try typedef typename union unsigned using virtual void volatile
  while break continue KOBOSHI_ASSERT
""".split())
# Tokens that follow the first name of an expression statement.
AFTER_NAME = (".", "->", "(", "[", "=", "++", "--", "+=", "-=", "*=", "/=", "|=", "&=", "^=", "<<=", ">>=")


class Mutation:
    """A change of one file: the text from `begin` to `end` becomes `new`."""

    def __init__(self, path, text, begin, end, new):
        self.path, self.begin, self.end, self.new = path, begin, end, new
        self.line = text.count("\n", 0, begin) + 1
        first = text.rfind("\n", 0, begin) + 1
        last = text.find("\n", end)
        self.before = " ".join(text[first:last].split())
        self.after = " ".join((text[first:begin] + new + text[end:last]).split())

    def change(self):
        return f"{self.before}  ->  {self.after}"

    def key(self):
        """The identity of the mutant, which stays the same while other lines come and go."""
        return f"{self.path}: {self.change()}"


def tokens_of(text):
    return [(match.lastgroup, match.group(), match.start(), match.end()) for match in TOKEN.finditer(text)
            if match.lastgroup != "comment"]


def changed_number(number):
    """Other values for a literal, in its own base and with its own suffix."""
    match = re.fullmatch(r"(0[xX][0-9a-fA-F']+|[0-9']+)([uUlLzZ]*)", number)
    if not match:
        match = re.fullmatch(r"([0-9']+\.[0-9']*)(\w*)", number)
        return [f"{float(match[1].replace(chr(39), '')) + 1.0}{match[2]}"] if match else []
    digits, suffix = match[1].replace("'", ""), match[2]
    base = 16 if digits[:2] in ("0x", "0X") else 10
    value = int(digits, base)
    return [f"{other:#X}{suffix}".replace("X", "x", 1) if base == 16 else f"{other}{suffix}"
            for other in (value + 1, value - 1) if other >= 0]


def closing(tokens, opening):
    """The index of the bracket that closes the one at `opening`, or None."""
    depth = 0
    for index in range(opening, len(tokens)):
        depth += tokens[index][1] in ("(", "[", "{")
        depth -= tokens[index][1] in (")", "]", "}")
        if depth == 0:
            return index
    return None


def statement_end(tokens, first):
    """The index of the semicolon that ends the expression statement at `first`, or None if none begins there."""
    kind, word = tokens[first][:2]
    if kind != "word" or word in NO_STATEMENT:
        return None
    index = first + 1
    while index + 1 < len(tokens) and tokens[index][1] == "::":
        index += 2
    if index >= len(tokens) or tokens[index][1] not in AFTER_NAME:  # a declaration has another name or a bracket here
        return None
    calls = False
    while index < len(tokens) and tokens[index][1] != ";":
        calls = calls or tokens[index][1] in ("(", "++", "--") or tokens[index][1].endswith("=")
        if tokens[index][1] in ("(", "[", "{"):
            index = closing(tokens, index)
            if index is None:
                return None
        elif tokens[index][1] in ("}", ")"):
            return None
        index += 1
    return index if calls and index < len(tokens) else None


def skipped_ranges(tokens):
    """Indices inside assertions: they check what cannot happen, so no test could notice."""
    skipped = set()
    for index, (_, word, _, _) in enumerate(tokens[:-1]):
        if word in ("KOBOSHI_ASSERT", "static_assert") and tokens[index + 1][1] == "(":
            skipped.update(range(index, (closing(tokens, index + 1) or index) + 1))
    return skipped


def mutations_of(path):
    """All mutations of a file, in the order of its text."""
    text = (ROOT / path).read_text()
    tokens = tokens_of(text)
    skipped = skipped_ranges(tokens)
    found = []

    def add(begin, end, *replacements):
        found.extend(Mutation(path, text, begin, end, new) for new in replacements)

    for index, (kind, word, begin, end) in enumerate(tokens):
        if index in skipped:
            continue
        before = tokens[index - 1][1] if index > 0 else ""
        blank_before, blank_after = text[begin - 1:begin].isspace(), text[end:end + 1].isspace()
        if kind == "operator" and word in BINARY and blank_before and blank_after and before not in ("operator", "]"):
            add(begin, end, *BINARY[word])
        elif word in ("-", "!", "~") and not blank_after and before in ("(", ",", "=", "return", "{", "?", ":", "&&", "||", "*"):
            add(begin, end, "")
        elif kind == "number" and before not in ("case", "[", "<"):
            add(begin, end, *changed_number(word))
        elif kind == "word" and word in WORDS:
            add(begin, end, *WORDS[word])
        elif word in ("if", "while") and index + 1 < len(tokens) and tokens[index + 1][1] == "(":
            last = closing(tokens, index + 1)
            condition = (tokens[index + 1][3], tokens[last][2])
            if ";" not in text[slice(*condition)] and " = " not in text[slice(*condition)]:
                add(*condition, "false", *(["true"] if word == "if" else []))
        elif before in (";", "{", "}", ")", "else"):
            last = statement_end(tokens, index)
            if last is not None:
                add(begin, tokens[last][3], ";")
    return found


@dataclasses.dataclass
class TestProgram:
    """A GoogleTest program of the unchanged sources."""

    path: pathlib.Path
    folder: str  # in which it runs
    seconds: float  # of a run
    objects: set  # files that it and its libraries are linked from, relative to the folder of the build
    digest: bytes


class Copy:
    """A copy of the versioned files with a build of its own, which outlives this program."""

    def __init__(self, folder, preset, programs):
        self.folder, self.build = folder, folder / "build" / preset
        self.preset, self.names = preset, programs
        listing = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
        names = listing.split("\0")[:-1]
        self.remove_all_but({folder / name for name in names})
        for name in names:
            self.update(folder / name, ROOT / name)

    def remove_all_but(self, wanted):
        for place, folders, files in os.walk(self.folder):
            if pathlib.Path(place) == self.folder:
                folders[:] = [name for name in folders if name not in ("build", "tmp")]
            for name in files:
                if pathlib.Path(place) / name not in wanted:
                    (pathlib.Path(place) / name).unlink()

    @staticmethod
    def update(copy, original):
        """Equal files keep their times. Another one is new, so that what an interrupted run made of a mutant is built again."""
        if copy.exists() and copy.stat().st_mode == original.stat().st_mode and copy.read_bytes() == original.read_bytes():
            return
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(original, copy)

    def prepare(self, folders, defines):
        """Builds it, and runs each test program once. `folders` are those whose libraries are built without unity builds."""
        separate = f"^({'|'.join(folders)})(/|$)"
        self.run(["cmake", "--preset", self.preset, "-DBUILD_TESTING=ON", f"-DKOBOSHI_SEPARATE={separate}",
                  *(f"-D{define}" for define in defines)], check=True)
        self.build_command = ["ninja", "-C", str(self.build), *self.test_targets(self.names)]
        self.run(self.build_command, check=True)
        self.digests = {path: self.digest(path) for path in self.build.rglob("*.o")}
        listing = self.run(["ctest", "--test-dir", str(self.build), "--show-only=json-v1"], check=True).stdout
        self.programs = self.test_programs(json.loads(listing))

    def run(self, command, check=False, timeout=None, cwd=None):
        """Runs a command in a process group of its own, which ends with it. A time-out gives the exit status -SIGALRM."""
        process = subprocess.Popen(command, cwd=cwd or self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                   errors="replace", start_new_session=True,
                                   env={**os.environ, "TMPDIR": str(self.scratch())})
        try:
            output, _ = process.communicate(timeout=timeout)
            status = process.returncode
        except subprocess.TimeoutExpired:
            output, status = "", -signal.SIGALRM
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        process.wait()
        if check and status != 0:
            raise SystemExit(f"mutants.py: this failed in {self.folder}: {' '.join(command)}\n{output}")
        return subprocess.CompletedProcess(command, status, output)

    def test_targets(self, programs):
        """The programs to build; none: all that the preset has."""
        if not programs:
            return []
        listing = self.run(["ninja", "-C", str(self.build), "-t", "targets", "all"], check=True).stdout
        names = re.findall(r"^(bin/\w+_test): CXX_EXECUTABLE_LINKER", listing, re.MULTILINE)
        chosen = [name for name in names if re.fullmatch(programs, name.removeprefix("bin/"))]
        if not chosen:
            raise SystemExit(f"mutants.py: no test program of the preset {self.preset} has a name like {programs}")
        return chosen

    def scratch(self):
        folder = self.folder / "tmp"
        folder.mkdir(exist_ok=True)
        return folder

    def digest(self, path):
        """A hash of the code and data of an object file, without its debugging information."""
        stripped = self.scratch() / "stripped.o"
        subprocess.run(["objcopy", "--strip-debug", str(path), str(stripped)], check=True)
        return hashlib.sha256(stripped.read_bytes()).digest()

    def test_programs(self, listing):
        """The GoogleTest programs that were built, by their paths."""
        programs, seen = {}, set()
        for test in listing["tests"]:
            path = pathlib.Path(test.get("command", [""])[0])
            if path in seen or path.parent != self.build / "bin" or not re.fullmatch(self.names or ".*", path.name) or not path.exists():
                continue
            seen.add(path)
            folder = next((item["value"] for item in test["properties"] if item["name"] == "WORKING_DIRECTORY"), self.build)
            started = time.monotonic()
            result = self.run([str(path), "--gtest_brief=1"], cwd=folder)
            seconds = time.monotonic() - started
            if result.returncode == 0:
                inputs = self.run(["ninja", "-C", str(self.build), "-t", "inputs", f"bin/{path.name}"]).stdout
                objects = {line.strip() for line in inputs.splitlines() if line.endswith(".o")}
                programs[path] = TestProgram(path, folder, seconds, objects, hashlib.sha256(path.read_bytes()).digest())
            else:
                print(f"mutants.py: {path} fails without a mutant; it judges none", file=sys.stderr)
        return programs

    def judge(self, mutation):
        """The verdict and what noticed."""
        path = self.folder / mutation.path
        times = path.stat()
        original = path.read_text()
        started_ns = time.time_ns()
        path.write_text(original[:mutation.begin] + mutation.new + original[mutation.end:])
        try:
            return self.verdict(mutation, started_ns)
        finally:
            # The file is as old as before, so that only objects of the mutant are compiled again, when they are needed. They go
            # first: the next run then builds them anew even if this one is interrupted here.
            for compiled in self.compiled_since(self.digests, started_ns):
                if self.digest(compiled) != self.digests[compiled]:
                    compiled.unlink()
            path.write_text(original)
            os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))

    @staticmethod
    def compiled_since(paths, since_ns):
        return [path for path in paths if path.exists() and path.stat().st_mtime_ns > since_ns]

    def likely_first(self, mutation):
        """The test programs, first that of the mutant's folder, then the fastest."""
        parts = pathlib.PurePath(mutation.path).parent.parts
        folders = ["_".join(parts[:length]) for length in range(2, len(parts) + 1)]
        return sorted(self.programs.values(), key=lambda program: (
            -sum(program.path.name.startswith(folder) for folder in folders), program.seconds, program.path))

    def verdict(self, mutation, started_ns):
        """Builds and runs one program after the other: most mutants need no more than one."""
        compiles = False
        changes = False
        runs = False
        removed = {path for path in self.digests if not path.exists()}  # objects of an earlier mutant
        for program in self.likely_first(mutation):
            build = self.run(["ninja", "-C", str(self.build), f"bin/{program.path.name}"], timeout=1800)
            if build.returncode != 0:
                asserted = re.search(r"static assertion failed[^\n]*", build.stdout)
                return ("killed", asserted[0]) if asserted else ("invalid", "does not compile")
            compiled = self.compiled_since([self.build / name for name in program.objects], started_ns)
            compiles = compiles or not removed.issuperset(compiled)
            if all(self.digest(path) == self.digests[path] for path in compiled):
                continue
            changes = True
            if hashlib.sha256(program.path.read_bytes()).digest() == program.digest:  # its library has the object, it has not
                continue
            runs = True
            result = self.run([str(program.path), "--gtest_brief=1", "--gtest_fail_fast"], cwd=program.folder,
                              timeout=10 + 10 * program.seconds)
            if result.returncode != 0:
                failed = re.search(r"\[  FAILED  \] ([\w/.]+)", result.stdout)
                reason = "takes too long" if result.returncode == -signal.SIGALRM else f"exit status {result.returncode}"
                return "killed", f"{program.path.name}: {failed[1] if failed else reason}"
        if runs:
            return "survived", ""
        return ("equivalent", "the same optimised code") if compiles and not changes else ("invalid", "in no program of this preset")


def judged_equivalent():
    """Mutants that somebody judged: each line is a key, ` | `, and the reason."""
    if not JUDGED.exists():
        return {}
    lines = [line for line in JUDGED.read_text().splitlines() if line and not line.startswith("#")]
    return dict(line.rsplit(" | ", 1) for line in lines)


def drawn(folders, seed, only):
    """All mutations of the folders, in an order that the seed and each mutation's own text decide: a change of one line leaves
    the others where they are."""
    listing = subprocess.run(["git", "ls-files", *folders], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    paths = [path for path in listing.splitlines() if path.endswith((".h", ".cc")) and re.search(only, path)]
    everything = [mutation for path in paths for mutation in mutations_of(path)]
    return sorted(everything, key=lambda mutation: hashlib.sha256(f"{seed} {mutation.key()}".encode()).digest())


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1].removeprefix("Usage: "), description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="*", default=["firmware"], metavar="FOLDER")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--skip", type=int, default=0, help="how many of the first mutants to leave out")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--at-least", type=float, default=0.0)
    parser.add_argument("--only", default="", help="a regular expression of paths")
    parser.add_argument("--programs", default="", help="a regular expression of test programs' names")
    parser.add_argument("--define", action="append", default=[], metavar="NAME=VALUE", help="a setting for CMake")
    arguments = parser.parse_args()
    mutations = drawn(arguments.folders, arguments.seed, arguments.only)
    if not mutations:
        parser.error(f"found no sources in {' '.join(arguments.folders)}, expected C++ files under version control")
    separate = sorted({"/".join(pathlib.PurePath(mutation.path).parent.parts[:2]) for mutation in mutations})
    preset = "firmware" if all(re.match(r"(hal|firmware)(/|$)", folder) for folder in arguments.folders) else "release"
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        copies = queue.Queue()
        # All copies at once, so that they are the same whatever is edited meanwhile; then one build after the other, so that
        # ccache, if it is here, compiles for the first alone.
        made = [Copy(ROOT / "build/mutants" / f"{preset}-{job}", preset, arguments.programs) for job in range(arguments.jobs)]
        for copy in made:
            copy.prepare(separate, arguments.define)
            copies.put(copy)
        equivalents = judged_equivalent()
        counts = dict.fromkeys(("killed", "survived", "equivalent", "invalid"), 0)

        def judge(mutation):
            if mutation.key() in equivalents:
                return mutation, ("equivalent", equivalents[mutation.key()])
            copy = copies.get()
            try:
                return mutation, copy.judge(mutation)
            finally:
                copies.put(copy)

        position = arguments.skip
        while (missing := arguments.count - counts["killed"] - counts["survived"]) > 0 and position < len(mutations):
            batch = mutations[position:position + missing]
            position += len(batch)
            for mutation, (verdict, noticed) in pool.map(judge, batch):
                counts[verdict] += 1
                print(f"{verdict:10} {mutation.path}:{mutation.line}: {mutation.change()}  {noticed}".rstrip(), flush=True)
    judged = counts["killed"] + counts["survived"]
    percent = 100.0 * counts["killed"] / judged if judged else 0.0
    print(f"{counts['killed']} of {judged} mutants killed ({percent:.1f} %), {counts['equivalent']} equivalent, "
          f"{counts['invalid']} invalid; {len(mutations)} possible, seed {arguments.seed}")
    return 1 if percent < arguments.at_least else 0


if __name__ == "__main__":
    sys.exit(main())
