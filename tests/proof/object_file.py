"""Reads from an object file or a static library what the proofs about the firmware need."""

import re
import subprocess

# Functions that the compiler calls implicitly and the board or the linker provides. All other undefined symbols are
# violations: operator new and delete, malloc, __cxa_throw, __cxa_guard_acquire, __muldf3 and the other helpers for
# float, ...
ALLOWED_UNDEFINED = {
    "_GLOBAL_OFFSET_TABLE_",
    "__assert_fail",  # assertion of a programmer's error; the board cuts the torque
    "__cxa_pure_virtual",
    "memcmp",
    "memcpy",
    "memmove",
    "memset",
}

SYMBOL = re.compile(r"^[0-9a-f]{16} (?P<flags>.{7}) (?P<section>\S+)\t(?P<size>[0-9a-f]+)\s+(?:\.hidden )?(?P<name>.*)$")
READ_ONLY_AFTER_LOADING = ".data.rel.ro"  # constant tables of pointers, in position-independent code
MUTABLE_SECTION = re.compile(r"^\.(data|bss|tdata|tbss)\b|^\*COM\*$")
RUN_TIME_TYPE = re.compile(r"^typeinfo (name )?for |^_ZT[IS]")


def symbols(path):
    output = subprocess.run(["objdump", "--syms", "--demangle", path], check=True, capture_output=True, text=True)
    return [match.groupdict() for match in map(SYMBOL.match, output.stdout.splitlines()) if match]


def symbol_violations(paths):
    """Returns a line for each symbol that a firmware object must not have: foreign functions, mutable data, run-time types."""
    found = [symbol for path in paths for symbol in symbols(path)]
    defined = {symbol["name"] for symbol in found if symbol["section"] != "*UND*"}
    violations = set()
    for symbol in found:
        name, section = symbol["name"], symbol["section"]
        if section == "*UND*" and name not in defined | ALLOWED_UNDEFINED:
            violations.add(f"uses {name}")
        if "d" not in symbol["flags"] and MUTABLE_SECTION.match(section) and not section.startswith(READ_ONLY_AFTER_LOADING):
            violations.add(f"mutable data {name} in {section}")
        if RUN_TIME_TYPE.match(name):
            violations.add(f"run-time type information {name}")
    return sorted(violations)


# --- debug information ---

ENTRY = re.compile(r"^ <(?P<depth>[0-9a-f]+)><(?P<offset>[0-9a-f]+)>: Abbrev Number: \d+ \(DW_TAG_(?P<tag>\w+)\)")
ATTRIBUTE = re.compile(r"^ +<[0-9a-f]+> +DW_AT_(?P<key>\w+) *:"
                       r" (\(\w+\) )?(\((indirect (line )?string, )?offset: \w+\): )?(?P<value>.*)$")
REFERENCE = re.compile(r"^<0x([0-9a-f]+)>")
LIBRARY_NAMESPACES = {"std", "__gnu_cxx"}
RESERVED_NAME = re.compile(r"^_[_A-Z]")
HOLDERS = {"variable", "member", "formal_parameter"}
FLOAT_ENCODINGS = {"3", "4"}  # DW_ATE_complex_float, DW_ATE_float


class Entry:
    """A debug information entry with its tag, attributes, parent and children."""

    def __init__(self, tag, parent):
        self.tag, self.parent, self.children, self.attributes = tag, parent, [], {}

    def name(self):
        return self.attributes.get("name", "")

    def reference(self, key):
        match = REFERENCE.match(self.attributes.get(key, ""))
        return match and match[1]

    def qualified_name(self):
        outer = self.parent.qualified_name() if self.parent else ""
        return f"{outer}::{self.name()}" if outer and self.name() else outer or self.name()

    def in_library(self):
        return (self.tag == "namespace" and self.name() in LIBRARY_NAMESPACES) or (
            self.parent is not None and self.parent.in_library())


def debug_entries(path):
    """Returns the entries of each object in the file, by offset."""
    output = subprocess.run(["readelf", "--debug-dump=info", path], check=True, capture_output=True, text=True)
    objects, entries, stack = [], {}, []
    for line in output.stdout.splitlines():
        if line.startswith("Contents of the .debug_info section"):
            entries, stack = {}, []
            objects.append(entries)
        elif match := ENTRY.match(line):
            del stack[int(match["depth"], 16):]
            is_unit = match["tag"] in {"compile_unit", "partial_unit"}
            entry = Entry(match["tag"], stack[-1] if stack and not is_unit and stack[-1].tag != "compile_unit" else None)
            if stack:
                stack[-1].children.append(entry)
            stack.append(entry)
            entries[match["offset"]] = entry
        elif (match := ATTRIBUTE.match(line)) and stack:
            stack[-1].attributes[match["key"]] = match["value"].strip()
    return objects


def holds_float(entry, entries, visited):
    """Returns whether a value of this type contains a float at any depth."""
    if entry is None or id(entry) in visited:
        return False
    visited.add(id(entry))
    if entry.tag == "base_type":
        return entry.attributes.get("encoding", "").split()[0] in FLOAT_ENCODINGS
    if holds_float(entries.get(entry.reference("type")), entries, visited):
        return True
    return any(holds_float(child, entries, visited) for child in entry.children if child.tag in {"member", "inheritance"})


def float_violations(path):
    """Returns a line for each variable, member or parameter outside the standard library whose type contains a float."""
    violations = set()
    for entries in debug_entries(path):
        for entry in entries.values():
            if entry.tag not in HOLDERS or not entry.name() or RESERVED_NAME.match(entry.name()) or entry.in_library():
                continue
            if holds_float(entries.get(entry.reference("type")), entries, set()):
                violations.add(f"{entry.tag} {entry.qualified_name()} holds a float")
    return sorted(violations)
