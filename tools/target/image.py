"""Reads a linked Cortex-M4 image: its sections, where its bytes come from, and who calls whom with how much stack.

The calls are read from the disassembly of the image itself, so that inlining, the linker and the compiler's library are
as they are. The stack of a function is what GCC says of it (-fcallgraph-info=su,da); of library code, which was compiled
without that, what its pushes add up to.

A function of the image holds those that were inlined into it. Which of them an instruction is of is read from the debug
information.
"""

import bisect
import pathlib
import re
import subprocess
from collections import defaultdict
from dataclasses import dataclass, field

PREFIX = "arm-none-eabi-"


def tool(name, *arguments):
    return subprocess.run([PREFIX + name, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def run_with_input(name, text, *arguments):
    command = [PREFIX + name, *map(str, arguments)]
    return subprocess.run(command, input=text, check=True, capture_output=True, text=True).stdout.splitlines()


@dataclass(frozen=True)
class Frame:
    """A function of the source that an instruction is of, inlined or not, and the line that the instruction is of."""
    name: str  # short
    file: str  # from the project's root
    line: str


@dataclass
class Instruction:
    address: int
    size: int
    mnemonic: str
    operands: str
    frames: list = field(default_factory=list)  # innermost first; none in the compiler's library

    def origins(self):
        """The functions of source files that it is of: what a header's functions do is work of who uses them."""
        return [frame for frame in self.frames if frame.file.endswith(".cc")] or self.frames[-1:]


@dataclass
class Function:
    address: int
    name: str  # as the linker knows it; the first of several
    demangled: str
    names: set = field(default_factory=set)
    calls: set = field(default_factory=set)  # addresses; tail calls are in both
    tail_calls: set = field(default_factory=set)
    indirect_calls: list = field(default_factory=list)  # instructions
    pushed_bytes: int = 0  # the sum of all pushes; no less than what any path through it pushes
    plain: bool = False  # all its stack is the compiler's doing, which gives it back before it ends in a call
    instructions: list = field(default_factory=list)
    frame_bytes: int = 0
    dynamic: bool = False  # takes stack by an amount that is not known when it is compiled

    @property
    def short_name(self):
        """Without namespace koboshi, parameters and the compiler's remark that it is a clone."""
        return short(self.demangled)


def short(demangled):
    name = re.sub(r" \[clone [^]]*\]", "", demangled).replace("(anonymous namespace)", "{}")
    name = re.sub(r"\(.*?\)( const)?(?=::|$)", "", name)  # parameters, also of the function that a lambda is in
    name = re.sub(r"^non-virtual thunk to ", "", name)
    if "<" in name.split("::")[-1] and " " in name.split("<")[0]:
        name = name.split(" ", 1)[1]  # a template's return type
    return name.replace("{}", "(anonymous)").removeprefix("koboshi::")


# --- sections -------------------------------------------------------------------------------------------------------------

SECTION = re.compile(r"^ +\d+ (?P<name>\S+) +(?P<size>[0-9a-f]{8}) +(?P<vma>[0-9a-f]{8}) +(?P<lma>[0-9a-f]{8})")


def sections(elf):
    """{name: (address, size)} of what is in the processor's memory or gets there."""
    found, name = {}, None
    for line in tool("objdump", "-h", elf).splitlines():
        if match := SECTION.match(line):
            name = match
        elif name and "ALLOC" in line:
            found[name["name"]] = (int(name["vma"], 16), int(name["size"], 16))
    return found


FLASH_SECTIONS = (".text", ".ARM.exidx", ".ARM.extab", ".init_array", ".data")
RAM_SECTIONS = (".stack", ".data", ".bss", ".noinit")


def total_bytes(elf, names):
    return sum(size for name, (_, size) in sections(elf).items() if name in names)


# --- functions ------------------------------------------------------------------------------------------------------------

HEADER = re.compile(r"^(?P<address>[0-9a-f]{8}) <(?P<name>.*)>:$")
INSTRUCTION = re.compile(r"^ +(?P<address>[0-9a-f]+):\t(?P<code>[0-9a-f]{4}(?: [0-9a-f]{4})?) +\t"
                         r"(?P<mnemonic>[a-z][\w.]*)\t?(?P<operands>[^@;]*)")
CONDITION = "(eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)?"
CALL = re.compile(rf"^bl{CONDITION}(\.w)?$")
BRANCH = re.compile(rf"^bl?{CONDITION}(\.[nw])?$|^cbn?z$")
REGISTERS = re.compile(r"\{([^}]*)\}")


def pushed(mnemonic, operands):
    """How many bytes the instruction takes from the stack; None when that is not known."""
    base = mnemonic.split(".")[0]
    if base == "push" or (base == "stmdb" and operands.startswith("sp!")):
        total = 0
        for item in REGISTERS.search(operands)[1].split(","):
            low, _, high = item.strip().partition("-")
            total += 4 * (int(high[1:]) - int(low[1:]) + 1 if high else 1)
        return total
    if base in ("str", "strd") and (match := re.search(r"\[sp, #-(\d+)\]!", operands)):
        return int(match[1])
    if base in ("sub", "subw") and re.match(r"sp,", operands):
        match = re.fullmatch(r"sp, (?:sp, )?#(\d+)", operands.strip())
        return int(match[1]) if match else None
    return 0


def read_symbols(elf):
    """{address: {(mangled, demangled)}} of functions."""
    found = defaultdict(set)
    table = [line.split() for line in tool("readelf", "-sW", elf).splitlines()]
    mangled = [words for words in table if len(words) >= 8 and words[3] == "FUNC"]
    names = "".join(words[7] + "\n" for words in mangled)
    for words, name in zip(mangled, run_with_input("c++filt", names)):
        found[int(words[1], 16) & ~1].add((words[7], name))
    return found


def read_sources(elf, functions):
    """Fills in the frames of all instructions, from the debug information. What has none goes with what is before it."""
    instructions = [instruction for function in functions.values() for instruction in function.instructions]
    addresses = "".join(f"{instruction.address:#x}\n" for instruction in instructions)
    by_address = {f"{instruction.address:#010x}": instruction for instruction in instructions}
    current = None
    lines = iter(run_with_input("addr2line", addresses, "-a", "-f", "-i", "-C", "-e", elf))
    for line in lines:
        if line in by_address:
            current = by_address[line]
        else:
            file, _, number = next(lines).rpartition(":")
            if file not in ("", "??"):
                current.frames.append(Frame(short(line), file.removeprefix("./"), number.split()[0]))
    for function in functions.values():
        known = next((instruction.frames[-1:] for instruction in function.instructions if instruction.frames), [])
        for instruction in function.instructions:  # the compiler leaves out the first here and there
            instruction.frames = known = instruction.frames or known


def disassemble(elf):
    """{address: Function} of everything in .text that is executed."""
    symbols = read_symbols(elf)
    functions, current = {}, None
    for line in tool("objdump", "-d", elf).splitlines():
        if match := HEADER.match(line):
            address, current = int(match["address"], 16), None
            if aliases := sorted(symbols.get(address, ())):  # constants are disassembled too, and are not looked at
                current = functions[address] = Function(address, *aliases[0], names={alias[0] for alias in aliases})
        elif current and (match := INSTRUCTION.match(line)):
            address, size = int(match["address"], 16), len(match["code"].replace(" ", "")) // 2
            current.instructions.append(Instruction(address, size, match["mnemonic"], match["operands"].strip()))
    read_sources(elf, functions)
    starts = sorted(functions)
    for function in functions.values():
        read_calls(function, starts)
    return functions


def read_calls(function, starts):
    for instruction in function.instructions:
        mnemonic, operands = instruction.mnemonic, instruction.operands
        base = mnemonic.split(".")[0]
        taken = pushed(mnemonic, operands)
        function.dynamic = function.dynamic or taken is None
        function.pushed_bytes += taken or 0
        if BRANCH.match(mnemonic):
            target = int(re.search(r"([0-9a-f]+) <", operands)[1], 16)
            callee = starts[bisect.bisect_right(starts, target) - 1]  # the compiler's library calls into the middle of functions
            is_call = CALL.match(mnemonic) is not None
            if is_call or callee != function.address:
                function.calls.add(callee)
            if not is_call and callee != function.address:
                function.tail_calls.add(callee)
        elif base.startswith("blx") or (base.startswith("bx") and operands != "lr"):
            function.indirect_calls.append(instruction)


CI_NODE = re.compile(r'^node: \{ title: "(?P<title>[^"]*)" label: "(?P<label>[^"]*)"')
CI_FRAME = re.compile(r"(\d+) bytes \(([\w,]+)\)")


def read_stack(paths):
    """{mangled name: (bytes, dynamic)} from GCC's .ci files; of equal names the larger."""
    frames = {}
    for path in paths:
        for line in pathlib.Path(path).read_text().splitlines():
            match = CI_NODE.match(line)
            frame = match and CI_FRAME.search(match["label"])
            if frame:
                name = match["title"].rsplit(":", 1)[-1]
                size, dynamic = frames.get(name, (0, False))
                frames[name] = (max(size, int(frame[1])), dynamic or frame[2] == "dynamic")
    return frames


def words(elf, section):
    """{address: value} of a section's contents."""
    found = {}
    for line in tool("objdump", "-s", "-j", section, elf).splitlines():
        if match := re.match(r"^ ([0-9a-f]+) ((?:[0-9a-f]{2,8} ){1,4})", line):
            data = bytes.fromhex(match[2].replace(" ", ""))
            for offset in range(0, len(data) - 3, 4):
                found[int(match[1], 16) + offset] = int.from_bytes(data[offset:offset + 4], "little")
    return found


def ci_files(build_folder):
    """The sources of the firmware and its board, without the programs beside them."""
    return [path for folder in ("firmware", "hal") for path in sorted(pathlib.Path(build_folder, folder).rglob("*.ci"))]


class Image:
    """An image with the .ci files of what was compiled for it; the linker's map lies beside it."""

    def __init__(self, elf, ci_files):
        self.elf = pathlib.Path(elf)
        self.functions = disassemble(elf)
        frames = read_stack(ci_files)
        for function in self.functions.values():
            known = [frames[name] for name in function.names if name in frames]
            function.frame_bytes = max([function.pushed_bytes, *(size for size, _ in known)])
            function.dynamic = any(dynamic for _, dynamic in known) if known else function.dynamic
            function.plain = max((size for size, _ in known), default=-1) >= function.pushed_bytes

    @classmethod
    def of_build(cls, build_folder):
        return cls(pathlib.Path(build_folder) / "bin/koboshi.elf", ci_files(build_folder))

    def named(self, short_name):
        """All functions of that name: overloads, and thunks to them."""
        return [function for function in self.functions.values() if function.short_name == short_name]


# --- where bytes come from ------------------------------------------------------------------------------------------------

MAP_LINE = re.compile(r"^ (?P<section>\.\S+|\*fill\*)?\s+0x(?P<address>[0-9a-f]+)\s+0x(?P<size>[0-9a-f]+)(?: (?P<file>\S+))?")
OUTPUT_SECTION = re.compile(r"^(?P<name>\.\S+)")


def folder_of(file):
    """firmware/app of firmware/app/libfirmware_app.a(controller.cc.obj), libgcc of the compiler's library."""
    if not file:
        return "(padding)"
    if match := re.match(r"/.*/lib(\w+)\.a\(", file):
        return "lib" + match[1]
    return "/".join(part for part in pathlib.PurePath(file.split("(")[0]).parts[:-1] if part not in ("CMakeFiles", "Unity") and "." not in part)


def bytes_by_folder(map_file):
    """{folder: {"flash_bytes": n, "ram_bytes": n}}: what the linker placed, by the library or program that it is from."""
    result = defaultdict(lambda: {"flash_bytes": 0, "ram_bytes": 0})
    lines = pathlib.Path(map_file).read_text().split("Linker script and memory map", 1)[1].splitlines()
    joined = re.sub(r"\n( \.\S+)\n {10,}", r"\n\1 ", "\n" + "\n".join(lines))  # long names stand on a line of their own
    output = None
    for line in joined.splitlines():
        if match := OUTPUT_SECTION.match(line):
            output = match["name"]
        match = MAP_LINE.match(line)
        if not match or not match["section"] or not (match["file"] or match["section"] == "*fill*"):
            continue
        folder = "(stack)" if output == ".stack" else folder_of(match["file"])
        if output in FLASH_SECTIONS:
            result[folder]["flash_bytes"] += int(match["size"], 16)
        if output in RAM_SECTIONS:
            result[folder]["ram_bytes"] += int(match["size"], 16)
    return {folder: sizes for folder, sizes in sorted(result.items()) if any(sizes.values())}
