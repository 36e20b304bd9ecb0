"""Who may call whom in an image, with the calls through pointers bounded by a list, and how deep the stack gets."""

import pathlib
import re

LISTED = re.compile(r"(?P<caller>\S.*?) (?P<places>\d+):(?P<targets>.*)")  # no target: none is in the image

NOBODY = "nobody"  # in the list, what no call reaches although its address is taken

# Bytes that the core pushes when it takes an exception: 8 words, and one more to align the stack (ARMv7-M, B1.5.7).
EXCEPTION_BYTES = 32 + 4


def read_list(path):
    """{caller: (places, [target])}"""
    entries = {}
    for line in pathlib.Path(path).read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            match = LISTED.fullmatch(line.strip())
            _, targets = entries.get(match["caller"], (0, []))
            entries[match["caller"]] = (int(match["places"]), targets + match["targets"].split())
    return entries


class CallGraph:
    """The list names functions of the source, which are the same wherever the compiler has inlined them."""

    def __init__(self, image, listed):
        self.image, self.listed = image, listed
        self.functions = image.functions
        by_name = {}
        for function in self.functions.values():
            by_name.setdefault(function.short_name, []).append(function.address)
        self.by_name = by_name
        self.places = {}  # {caller: {line of the source}}
        self.indirect = {function.address: self._may_call(function) for function in self.functions.values()}

    def _may_call(self, function):
        """The functions that calls through pointers reach, by the list."""
        reached = set()
        for call in function.indirect_calls:
            caller = call.frames[0].name if call.frames else function.short_name
            self.places.setdefault(caller, set()).add((call.frames[0].file, call.frames[0].line) if call.frames else call.address)
            reached |= {address for target in self.listed.get(caller, (0, []))[1] for address in self.by_name.get(target, [])}
        return reached

    def list_violations(self):
        """Lines about calls through pointers that the list does not have as they are, and about what it has too much."""
        found = []
        for caller, lines in self.places.items():
            expected = self.listed.get(caller, (0, []))[0]
            if expected != len(lines):
                found.append(f"indirect: {caller} calls through pointers at {len(lines)} places, the list has {expected}")
        for caller, (_, targets) in self.listed.items():
            if caller not in self.places and caller != NOBODY:
                found.append(f"indirect: {caller} is in the list and calls through no pointer")
            found += [f"indirect: {target}, which {caller} may call, is not in the image"
                      for target in targets if target not in self.by_name]
        return found

    def callees(self, address):
        function = self.functions[address]
        return sorted(function.calls | self.indirect[address])

    def cycles(self):
        """Lines about functions that can call themselves, through others or not."""
        found, done = [], set()

        def visit(address, path):
            if address in path:
                names = [self.functions[step].short_name for step in path[path.index(address):] + [address]]
                found.append("recursion: " + " -> ".join(names))
                return
            if address not in done:
                for callee in self.callees(address):
                    visit(callee, path + [address])
                done.add(address)

        for address in self.functions:
            visit(address, [])
        return found

    def dynamic_frames(self):
        """Lines about functions that take stack by an amount known only when they run."""
        return [f"stack: {function.short_name} takes stack by an amount that is not known beforehand"
                for function in self.functions.values() if function.dynamic]

    def deepest(self, address):
        """The most stack in bytes from this function on, and the functions that take it. There must be no cycles."""
        known = {}

        def visit(address):
            if address not in known:
                function = self.functions[address]
                best = (function.frame_bytes, [address])
                for callee in self.callees(address):
                    depth, path = visit(callee)
                    kept = 0 if callee in function.tail_calls and function.plain else function.frame_bytes
                    best = max(best, (kept + depth, [address, *path]))
                known[address] = best
            return known[address]

        return visit(address)
