"""canopen_test.py KOBOSHI LOG...: compares Wireshark's CANopen dissector with `koboshi can dump` on each log: all fields of
NMT, SYNC, EMCY, heartbeat and SDO. Frames of block transfers are excluded: the dump only names their service."""

import collections
import subprocess
import sys
import unittest

KOBOSHI, *LOGS = sys.argv[1:]

FIELDS = ("can.id canopen.nmt_ctrl.cd canopen.nmt_ctrl.node_id canopen.sync.counter canopen.em.err_code canopen.em.err_reg "
          "canopen.nmt_guard.state canopen.sdo.cmd canopen.sdo.ccs canopen.sdo.scs canopen.sdo.e canopen.sdo.s canopen.sdo.n "
          "canopen.sdo.main_idx canopen.sdo.sub_idx canopen.sdo.data.bytes canopen.sdo.abort_code").split()
COMMANDS = {1: "start", 2: "stop", 128: "enter pre-operational", 129: "reset node", 130: "reset communication"}
STATES = {0: "boot-up", 4: "stopped", 5: "operational", 127: "pre-operational"}
ABORT = 4
BOOLEANS = {"True": "1", "False": "0"}  # so prints a flag since Wireshark 4.2


def dissect(log):
    """Returns the fields of each frame that tshark prints: {field: value}, with numbers where possible."""
    arguments = [argument for field in FIELDS for argument in ("-e", field)]
    output = subprocess.run(["tshark", "-r", log, "-d", "can.subdissector,canopen", "-T", "fields", *arguments],
                            check=True, capture_output=True, text=True).stdout
    for line in output.splitlines():
        values = dict(zip((field.rpartition(".")[2] for field in FIELDS), line.split("\t"), strict=True))
        yield {name: value if name == "bytes" else int(BOOLEANS.get(value, value), 0) for name, value in values.items() if value}


def dump(log):
    """Returns our decoder's text of each frame."""
    output = subprocess.run([KOBOSHI, "can", "dump", log], check=True, capture_output=True, text=True).stdout
    return [line[12:].split(maxsplit=1)[1] if len(line.split()) > 2 else "" for line in output.splitlines()]


def sdo_text(seen):
    """Returns the expected text of a dissected SDO. For an abort it is only the beginning, without the text of the code."""
    request = "ccs" in seen
    specifier = seen["ccs"] if request else seen["scs"]
    if specifier == ABORT:
        return f"abort {seen['main_idx']:04X}:{seen['sub_idx']:02X}: {seen['abort_code']:08X} "
    what = {True: ["write segment", "write", "read", "read segment"],
            False: ["read segment answered", "write segment done", "read answered", "write done"]}[request][specifier]
    if "main_idx" not in seen:
        return what
    what += f" {seen['main_idx']:04X}:{seen['sub_idx']:02X}"
    if seen.get("e"):
        data = bytes.fromhex(seen["bytes"].replace(":", ""))
        return f"{what} = 0x{data[:4 - seen['n']][::-1].hex().upper()}"
    return f"{what}, {int.from_bytes(bytes.fromhex(seen['bytes'].replace(':', '')), 'little')} bytes" if seen.get("s") else what


def words(seen):
    """Returns the service of a dissected frame and our decoder's expected text, or nothing for a PDO."""
    identifier = seen["id"]
    node = f"node {identifier & 0x7F}"
    if "cd" in seen:
        return "NMT", f"NMT {'node ' + str(seen['node_id']) if seen['node_id'] else 'all nodes'}: {COMMANDS[seen['cd']]}"
    if identifier == 0x080:
        return "SYNC", f"SYNC {seen['counter']}" if "counter" in seen else "SYNC"
    if "err_code" in seen:
        return "EMCY", f"EMCY {node}: {seen['err_code']:04X} "
    if "state" in seen:
        return "heartbeat", f"heartbeat {node}: {STATES[seen['state']]}"
    if "cmd" in seen:
        return "SDO", f"SDO {node}: {sdo_text(seen)}"
    return None


class CanOpen(unittest.TestCase):
    def test_is_read_alike(self):
        for log in LOGS:
            services = collections.Counter()
            dissected = list(dissect(log))
            ours = dump(log)
            self.assertEqual(len(ours), len(dissected))
            for number, (seen, text) in enumerate(zip(dissected, ours), 1):
                told = words(seen)
                if told is None:
                    # Neither program may decode a frame that the other does not.
                    self.assertFalse(text.startswith(("NMT", "SYNC", "EMCY", "heartbeat", "SDO")), f"{log}:{number}: {text}")
                    continue
                service, expected = told
                services[service] += 1
                if expected.endswith(" "):  # a code, followed by its name
                    self.assertTrue(text.startswith(expected), f"{log}:{number}: '{text}' for '{expected}'")
                else:
                    self.assertEqual(text, expected, f"{log}:{number}")
                if service == "EMCY":
                    self.assertTrue(text.endswith(f", register {seen['err_reg']:02X}"), f"{log}:{number}: {text}")
            print(f"{log}: {len(ours)} frames, " + ", ".join(f"{count} {name}" for name, count in sorted(services.items())))
            self.assertIn("heartbeat", services, log)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
