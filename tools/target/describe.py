"""Writes what an image takes of flash, RAM and stack, and where its functions are: NAME.elf.json beside NAME.elf.

Usage: describe.py BUILD_FOLDER
"""

import json
import pathlib
import sys

import call_graph
import image as target_image

LIST = pathlib.Path(__file__).parent / "indirect_calls.txt"
VECTORS = 1 + 15 + 32  # words: the first stack pointer, the core's exceptions, the interrupts that the image has room for


def handlers(image):
    """Addresses of the functions in the vector table."""
    table = target_image.words(image.elf, ".text")
    return sorted({table[4 * number] & ~1 for number in range(1, VECTORS)})


def entry_points(image, graph):
    """{name: {"stack_bytes": n, "deepest": [function]}}: the vectors, and the two calls that the firmware consists of."""
    entries = handlers(image) + [function.address for name in ("app::Controller::service", "app::Controller::tick")
                                 for function in image.named(name)]
    found = {}
    for address in entries:
        depth, path = graph.deepest(address)
        found[image.functions[address].short_name] = {
            "stack_bytes": depth,
            "deepest": [image.functions[step].short_name for step in path],
        }
    return found


def describe(image, map_file):
    graph = call_graph.CallGraph(image, call_graph.read_list(LIST))
    violations = graph.list_violations() + graph.cycles() + graph.dynamic_frames()
    if violations:
        raise ValueError("the stack of the image has no bound:\n" + "\n".join(violations))
    by_entry_point = entry_points(image, graph)
    worst = max(entry["stack_bytes"] for entry in by_entry_point.values())
    return {
        "flash_bytes": target_image.total_bytes(image.elf, target_image.FLASH_SECTIONS),
        "ram_bytes": target_image.total_bytes(image.elf, target_image.RAM_SECTIONS),
        # A fault can come at the deepest point. Its handler starts the stack anew, but the core has pushed its frame by then.
        "stack_bytes": worst + call_graph.EXCEPTION_BYTES,
        "by_folder": target_image.bytes_by_folder(map_file),
        "by_entry_point": by_entry_point,
        "functions": [{"name": function.short_name, "address": function.address, "size_bytes": function.size}
                      for _, function in sorted(image.functions.items())],
    }


if __name__ == "__main__":
    build_folder = pathlib.Path(sys.argv[1])
    image = target_image.Image.of_build(build_folder)
    description = describe(image, f"{image.elf}.map")
    pathlib.Path(f"{image.elf}.json").write_text(json.dumps(description, indent=2) + "\n")
