"""bus_yml_test.py FOLDER: checks bus.yml and the data sheets that it names by the rules of dcfgen of lely-core.

The keys are those of lely's documentation of dcf-tools. The test fails on all that dcfgen would refuse or warn about.
"""

import pathlib
import sys
import unittest

import yaml

from eds_test import BITS, number, read

FOLDER = pathlib.Path(sys.argv.pop(1)) if __name__ == "__main__" else None

MASTER = {"node_id": int, "baudrate": int, "vendor_id": int, "product_code": int, "revision_number": int, "serial_number": int,
          "heartbeat_multiplier": float, "heartbeat_consumer": bool, "heartbeat_producer": int, "emcy_inhibit_time": int,
          "sync_period": int, "sync_window": int, "sync_overflow": int, "error_behavior": dict, "nmt_inhibit_time": int,
          "start": bool, "start_nodes": bool, "start_all_nodes": bool, "reset_all_nodes": bool, "stop_all_nodes": bool,
          "boot_time": int}
SLAVE = {"dcf": str, "dcf_path": str, "node_id": int, "revision_number": int, "serial_number": int,
         "heartbeat_multiplier": float, "heartbeat_consumer": bool, "heartbeat_producer": int, "error_behavior": dict,
         "rpdo": dict, "tpdo": dict, "boot": bool, "mandatory": bool, "reset_communication": bool, "software_file": str,
         "software_version": int, "restore_configuration": int, "sdo": list}
# RPDOs have no event_deadline: dcfgen 2.3 cannot write it.
PDO = {"enabled": bool, "cob_id": int, "transmission": int, "inhibit_time": int, "event_timer": int, "sync_start": int,
       "mapping": list}
ENTRY = {"index": int, "sub_index": int}
REQUEST = ENTRY | {"value": int}
INVALID = 1 << 31


def load():
    with open(FOLDER / "bus.yml", encoding="ascii") as file:
        return yaml.safe_load(file)


class BusYml(unittest.TestCase):
    bus = {}

    @classmethod
    def setUpClass(cls):
        cls.bus = load()
        cls.slaves = {name: slave for name, slave in cls.bus.items() if name not in ("master", "options")}
        cls.eds = {slave["dcf"]: read(FOLDER / slave["dcf"]) for slave in cls.slaves.values()}

    def each_slave(self):
        for name, slave in self.slaves.items():
            with self.subTest(slave=name):
                yield slave, self.eds[slave["dcf"]]

    def section(self, eds, entry):
        """Returns where an EDS describes an object."""
        name, sub = f"{entry['index']:04X}", entry.get("sub_index", 0)
        self.assertTrue(eds.has_section(name), name)
        return eds[f"{name}sub{sub:X}" if eds.has_option(name, "SubNumber") else name]

    def expect_keys(self, given, known):
        for key, value in given.items():
            self.assertIn(key, known)
            self.assertIs(type(value), known[key], key)

    def test_has_only_keys_that_dcfgen_knows(self):
        self.expect_keys(self.bus["master"], MASTER)
        for slave, _ in self.each_slave():
            self.expect_keys(slave, SLAVE)
            for pdo in [*slave.get("rpdo", {}).values(), *slave.get("tpdo", {}).values()]:
                self.expect_keys(pdo, PDO)
                for entry in pdo["mapping"]:
                    self.expect_keys(entry, ENTRY)
            for request in slave.get("sdo", []):
                self.expect_keys(request, REQUEST)

    def test_has_each_node_once(self):
        ids = [self.bus["master"]["node_id"]] + [slave["node_id"] for slave in self.slaves.values()]
        self.assertEqual(ids, [1, *range(16, 39)])
        serials = [slave["serial_number"] for slave in self.slaves.values()]
        self.assertEqual(len(set(serials)), len(serials))
        self.assertNotIn(0, serials)

    def test_agrees_with_the_data_sheets(self):
        sheets = {16: "drive.eds", 35: "drive.eds", 36: "inertial.eds", 37: "ankle.eds", 38: "ankle.eds"}
        for slave, eds in self.each_slave():
            self.assertEqual(slave["dcf"], sheets.get(slave["node_id"], "drive.eds"))
            self.assertEqual(slave["revision_number"], number(eds["1018sub3"]["DefaultValue"]))
            self.assertEqual(slave["revision_number"], number(eds["DeviceInfo"]["RevisionNumber"]))
            for index in ("1000", "1018sub1", "1018sub2", "1018sub3"):
                self.assertIn("DefaultValue", eds[index])

    def test_can_supervise_each_slave(self):
        for slave, eds in self.each_slave():
            self.assertTrue(eds.has_section("1017"))
            if slave.get("heartbeat_consumer"):
                free = [s for s in eds.sections() if s.startswith("1016sub") and s != "1016sub0" and number(eds[s]["DefaultValue"]) == 0]
                self.assertNotEqual(free, [], "no free entry of 1016")
                self.assertGreater(self.bus["master"]["heartbeat_producer"], 0)

    def test_maps_what_can_be_mapped(self):
        identifiers = []
        for slave, eds in self.each_slave():
            for direction, first in (("rpdo", 0x1400), ("tpdo", 0x1800)):
                for i, pdo in slave.get(direction, {}).items():
                    communication = eds[f"{first + i - 1:04X}sub1"]
                    self.assertEqual(communication["AccessType"], "rw")
                    self.assertEqual(pdo["cob_id"] & INVALID, 0)
                    identifiers.append(pdo["cob_id"] & 0x7FF)
                    sections = [self.section(eds, entry) for entry in pdo["mapping"]]
                    self.assertEqual({section["PDOMapping"] for section in sections}, {"1"})
                    if direction == "rpdo":
                        self.assertEqual({section["AccessType"] for section in sections}, {"rww"})
                    self.assertLessEqual(sum(BITS[number(section["DataType"])] for section in sections), 64)
                    self.assertLessEqual(len(sections), number(eds[f"{first + 0x200 + i - 1:04X}"]["SubNumber"]) - 1)
        self.assertEqual(len(set(identifiers)), len(identifiers))
        self.assertEqual(len(identifiers), 40)

    def test_writes_what_can_be_written(self):
        for slave, eds in self.each_slave():
            for request in slave.get("sdo", []):
                section = self.section(eds, request)
                self.assertIn(section["AccessType"], ("rw", "rww", "wo"))
                data_type = number(section["DataType"])
                low, high = (-(1 << BITS[data_type] - 1), (1 << BITS[data_type] - 1) - 1) if data_type in (2, 3, 4) else (0, (1 << BITS[data_type]) - 1)
                self.assertLessEqual(max(low, number(section.get("LowLimit", str(low)))), request["value"])
                self.assertGreaterEqual(min(high, number(section.get("HighLimit", str(high)))), request["value"])

    def test_starts_a_drive_as_our_controller_does(self):
        drive = next(iter(self.slaves.values()))
        requests = {(request["index"], request["sub_index"]): request["value"] for request in drive["sdo"]}
        self.assertEqual(requests[0x6060, 0], 8)
        self.assertEqual(requests[0x1006, 0], self.bus["master"]["sync_period"])
        self.assertLess(requests[0x607D, 1], requests[0x607D, 2])
        self.assertEqual([entry["index"] for entry in drive["rpdo"][1]["mapping"]], [0x6040, 0x607A])
        self.assertEqual([entry["index"] for entry in drive["tpdo"][1]["mapping"]], [0x6041, 0x6064, 0x6077])


if __name__ == "__main__":
    unittest.main()
