"""Writes what an image takes of flash, RAM and stack, and where its code comes from: NAME.elf.json beside NAME.elf.

Usage: describe.py BUILD_FOLDER
"""

import json
import pathlib
import sys

import call_graph
import image as target_image

LIST = pathlib.Path(__file__).parent / "indirect_calls.txt"
VECTORS = 1 + 15 + 32  # words: the first stack pointer, the core's exceptions, the interrupts that the image has room for
CALLS = ("app::Controller::service", "app::Controller::tick")  # what a board makes of the firmware


def handlers(image):
    """Addresses of the functions in the vector table."""
    table = target_image.words(image.elf, ".text")
    return sorted({table[4 * number] & ~1 for number in range(1, VECTORS)})


def entry_points(image, graph):
    """{name: {"address": a, "stack_bytes": n, "deepest": [function]}}: the vectors, and the firmware's calls that are there."""
    entries = handlers(image) + [function.address for name in CALLS for function in image.named(name)]
    found = {}
    for address in entries:
        depth, path = graph.deepest(address)
        found[image.functions[address].short_name] = {
            "address": address,
            "stack_bytes": depth,
            "deepest": [image.functions[step].short_name for step in path],
        }
    return found


def budget(elf):
    """The sizes of the memories in the linker script."""
    values = {words[2]: int(words[0], 16) for words in map(str.split, target_image.tool("nm", elf).splitlines()) if len(words) == 3}
    return {f"{name}_bytes": values[f"image_{name}_size"] for name in ("flash", "ram", "stack")}


def code(image):
    """Stretches of code by the functions of the source that they are of, the innermost of those inlined first."""
    found = []
    for _, function in sorted(image.functions.items()):
        names = None
        for instruction in function.instructions:
            of_instruction = [frame.name for frame in instruction.origins()] or [function.short_name]
            if of_instruction != names:
                names = of_instruction
                found.append({"of": names, "address": instruction.address})
            found[-1]["size_bytes"] = instruction.address + instruction.size - found[-1]["address"]
    return found


def describe(image):
    graph = call_graph.CallGraph(image, call_graph.read_list(LIST))
    violations = graph.list_violations() + graph.cycles() + graph.dynamic_frames()
    if violations:
        raise ValueError("the stack of the image has no bound:\n" + "\n".join(violations))
    by_entry_point = entry_points(image, graph)
    if not by_entry_point.keys() >= set(CALLS):
        raise ValueError("the compiler has left no function of its own of " + " or ".join(CALLS))
    worst = max(entry["stack_bytes"] for entry in by_entry_point.values())
    return {
        "flash_bytes": target_image.total_bytes(image.elf, target_image.FLASH_SECTIONS),
        "ram_bytes": target_image.total_bytes(image.elf, target_image.RAM_SECTIONS),
        # A fault can come at the deepest point. Its handler starts the stack anew, but the core has pushed its frame by then.
        "stack_bytes": worst + call_graph.EXCEPTION_BYTES,
        "budget": budget(image.elf),
        "by_folder": target_image.bytes_by_folder(f"{image.elf}.map"),
        "by_entry_point": by_entry_point,
        "code": code(image),
    }


if __name__ == "__main__":
    build_folder = pathlib.Path(sys.argv[1])
    image = target_image.Image.of_build(build_folder)
    description = describe(image)
    pathlib.Path(f"{image.elf}.json").write_text(json.dumps(description, indent=2) + "\n")
