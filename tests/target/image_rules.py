"""Rules for a linked Cortex-M4 image. Each function returns one line for each violation."""

import re
import sys
import pathlib

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "tools/target"))
import call_graph  # noqa: E402
import describe  # noqa: E402
import image as target_image  # noqa: E402

FORBIDDEN_SYMBOLS = [
    ("heap", re.compile(r"^_?(malloc|free|calloc|realloc|sbrk)(_r)?$|^_Z(nw|na|dl|da)")),
    ("float", re.compile(r"^__aeabi_(c?[fd]|u?[il]2[fd]|h2[fd])|^__\w*(sf|df)([2-4]|[sd]i|[sd]f2)?$|^__float")),
    ("exceptions", re.compile(r"^__cxa_(?!pure_virtual$)|^_Unwind_|^__gxx_personality|^__gnu_unwind|^__aeabi_unwind")),
    ("run-time types", re.compile(r"^_ZT[IS]|^_ZTVN10__cxxabiv1|^__dynamic_cast$")),
    ("initialiser", re.compile(r"^_GLOBAL__(sub_)?I_|^__static_initialization_and_destruction")),
]
FORBIDDEN_SECTIONS = {".ARM.extab": "exceptions", ".init_array": "initialiser"}  # the only ones that image.ld can emit
CANNOT_UNWIND = 1  # the only entry of an exception index that needs no tables (Arm EHABI32, section 6)


def symbol_violations(elf):
    names = sorted({line.split()[-1] for line in target_image.tool("nm", elf).splitlines()})
    return [f"{rule}: {name}" for name in names for rule, pattern in FORBIDDEN_SYMBOLS if pattern.search(name)]


def section_violations(elf):
    found = [f"{FORBIDDEN_SECTIONS[name]}: section {name} has {size} bytes"
             for name, (_, size) in target_image.sections(elf).items() if name in FORBIDDEN_SECTIONS and size]
    index = list(target_image.words(elf, ".ARM.exidx").values()) if ".ARM.exidx" in target_image.sections(elf) else []
    return found + ["exceptions: a function can be unwound" for action in index[1::2] if action != CANNOT_UNWIND]


def instruction_violations(image):
    """Finds floating-point instructions: all that begin with v belong to the floating-point unit (ARMv7-M, A7.5)."""
    return [f"float: {instruction.mnemonic} in {function.short_name}" for function in image.functions.values()
            for instruction in function.instructions if instruction.mnemonic.startswith("v")]


RELOCATION = re.compile(r"([0-9a-f]{8})  [0-9a-f]{8} R_ARM_(ABS32|TARGET1|REL32|\S*MOV\S*)\b")


def taken_addresses(image, relocatable):
    """Returns the functions whose address is in the image's data, from the relocations that the linker has kept in `relocatable`."""
    taken, section = set(), None
    contents = {name: target_image.words(relocatable, name) for name in (".text", ".data")
                if name in target_image.sections(relocatable)}
    for line in target_image.tool("readelf", "-rW", relocatable).splitlines():
        if match := re.match(r"Relocation section '\.rel(\.\S+)'", line):
            section = match[1]
        elif section in contents and (match := RELOCATION.match(line)):
            if "MOV" in match[2]:
                raise ValueError(f"{line}: an address in two halves is not looked for")
            address = contents[section][int(match[1], 16)] & ~1
            if address in image.functions:
                taken.add(address)
    return taken


def address_violations(image, graph, relocatable):
    listed = {address for _, targets in graph.listed.values() for target in targets for address in graph.by_name.get(target, [])}
    return [f"indirect: the address of {image.functions[address].short_name} is taken, and no call in the list reaches it"
            for address in sorted(taken_addresses(image, relocatable) - listed - set(describe.handlers(image)))]


def stack_violations(image, graph):
    (_, reserved) = target_image.sections(image.elf)[".stack"]
    found = []
    for name, entry in describe.entry_points(image, graph).items():
        needed = entry["stack_bytes"] + call_graph.EXCEPTION_BYTES
        if needed > reserved:
            found.append(f"stack: {name} needs {needed} bytes of {reserved}: {' -> '.join(entry['deepest'])}")
    return found


def violations(image, listed, relocatable):
    """Returns the violations of all rules. `relocatable` is the same image with its relocations kept."""
    graph = call_graph.CallGraph(image, listed)
    cycles = graph.cycles()
    return (symbol_violations(image.elf) + section_violations(image.elf) + instruction_violations(image) +
            graph.list_violations() + address_violations(image, graph, relocatable) + cycles + graph.dynamic_frames() +
            ([] if cycles else stack_violations(image, graph)))
