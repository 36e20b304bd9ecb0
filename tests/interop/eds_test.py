"""eds_test.py FOLDER: checks the data sheets by the rules of CiA 306-1, in the manner of python-canopen."""

import configparser
import pathlib
import re
import sys
import unittest

FOLDER = pathlib.Path(sys.argv.pop(1)) if __name__ == "__main__" else pathlib.Path()
SECTIONS = ("FileInfo", "DeviceInfo", "DummyUsage", "Comments", "MandatoryObjects", "OptionalObjects", "ManufacturerObjects")
OBJECT = re.compile(r"^([0-9A-F]{4})$")
SUB_OBJECT = re.compile(r"^([0-9A-F]{4})sub([0-9A-F]{1,2})$")
DOMAIN, VARIABLE, ARRAY, RECORD = 2, 7, 8, 9
BITS = {1: 1, 2: 8, 3: 16, 4: 32, 5: 8, 6: 16, 7: 32}
VISIBLE_STRING = 9


def read(name):
    """Reads a data sheet strictly: a repeated section or entry is an error."""
    eds = configparser.RawConfigParser(inline_comment_prefixes=(";",), strict=True)
    eds.optionxform = str
    with open(FOLDER / name, encoding="ascii") as file:
        eds.read_file(file)
    return eds


def number(text, node_id=16):
    text, with_node_id = re.subn(r"\$NODEID\+", "", text)
    return int(text, 0) + with_node_id * node_id


class Eds:
    class Checks(unittest.TestCase):
        name = ""

        def setUp(self):
            self.eds = read(self.name)

        def test_has_the_sections(self):
            for section in SECTIONS:
                self.assertTrue(self.eds.has_section(section), section)
            self.assertEqual(self.eds["FileInfo"]["FileName"], self.name)
            self.assertEqual(self.eds["FileInfo"]["EDSVersion"], "4.0")

        def test_lists_every_object_once(self):
            listed = []
            for section in ("MandatoryObjects", "OptionalObjects", "ManufacturerObjects"):
                count = int(self.eds[section]["SupportedObjects"])
                self.assertEqual(list(self.eds[section]), ["SupportedObjects"] + [str(i + 1) for i in range(count)])
                listed += [int(self.eds[section][str(i + 1)], 0) for i in range(count)]
            described = [int(section, 16) for section in self.eds.sections() if OBJECT.match(section)]
            self.assertEqual(sorted(listed), sorted(described))
            self.assertEqual(len(set(listed)), len(listed))

        def test_has_the_sub_indices_that_it_counts(self):
            for section in filter(OBJECT.match, self.eds.sections()):
                subs = [s for s in self.eds.sections() if SUB_OBJECT.match(s) and s.startswith(section)]
                if number(self.eds[section]["ObjectType"]) in (VARIABLE, DOMAIN):
                    self.assertEqual(subs, [], section)
                elif "CompactSubObj" in self.eds[section]:
                    self.assertEqual(subs, [], section)
                    self.assertEqual(number(self.eds[section]["ObjectType"]), ARRAY)
                    self.assertIn(number(self.eds[section]["CompactSubObj"]), range(1, 255))
                else:
                    self.assertEqual(int(self.eds[section]["SubNumber"], 0), len(subs), section)
                    self.assertIn(f"{section}sub0", subs)

        def test_has_values_that_fit_their_types(self):
            for section in self.eds.sections():
                entry = self.eds[section]
                if not (OBJECT.match(section) or SUB_OBJECT.match(section)) or "DataType" not in entry:
                    continue
                with self.subTest(section=section):
                    self.assertIn(entry["AccessType"], ("ro", "rw", "rww", "wo", "const"))
                    self.assertIn(entry["PDOMapping"], ("0", "1"))
                    self.assertNotEqual(entry["ParameterName"], "")
                    data_type = number(entry["DataType"])
                    if data_type == VISIBLE_STRING or "DefaultValue" not in entry:
                        continue
                    value, bits = number(entry["DefaultValue"]), BITS[data_type]
                    low, high = (-2 ** (bits - 1), 2 ** (bits - 1) - 1) if data_type in (2, 3, 4) else (0, 2**bits - 1)
                    self.assertLessEqual(number(entry.get("LowLimit", str(low))), value)
                    self.assertGreaterEqual(number(entry.get("HighLimit", str(high))), value)

        def test_has_no_empty_values(self):
            # Readers expect a number here: dcfgen of lely-core refuses the whole file otherwise.
            for section in self.eds.sections():
                for key, value in self.eds[section].items():
                    self.assertNotEqual(value, "", f"[{section}] {key}")

        def test_has_no_defaults_of_process_values(self):
            for section in self.eds.sections():
                if self.eds[section].get("PDOMapping") == "1":
                    self.assertNotIn("DefaultValue", self.eds[section], section)

        def test_is_of_one_device_type(self):
            info = self.eds["DeviceInfo"]
            self.assertEqual(number(info["ProductNumber"]), self.product)
            self.assertEqual(number(info["ProductNumber"]), number(self.eds["1018sub2"]["DefaultValue"]))
            self.assertEqual(number(info["NrOfRXPDO"]), len([s for s in self.eds.sections() if re.match("^1[45]..$", s)]))
            self.assertEqual(number(info["NrOfTXPDO"]), len([s for s in self.eds.sections() if re.match("^1[89]..$", s)]))

        def test_maps_objects_that_may_be_mapped(self):
            for section in filter(re.compile(r"^1[6A]..sub[1-8]$").match, self.eds.sections()):
                entry = number(self.eds[section]["DefaultValue"])
                if entry == 0:
                    continue
                index, subindex, bits = f"{entry >> 16:04X}", f"{entry >> 8 & 255:X}", entry & 255
                mapped = self.eds[f"{index}sub{subindex}" if self.eds.has_section(f"{index}sub{subindex}") else index]
                self.assertEqual(mapped["PDOMapping"], "1", section)
                self.assertEqual(BITS[number(mapped["DataType"])], bits, section)


class Controller(Eds.Checks):
    name = "controller.eds"
    product = 0x4B01

    def default(self, section):
        return number(self.eds[section]["DefaultValue"], node_id=1)

    def test_has_the_pdos_of_its_drives(self):
        nodes = set(range(16, 36))
        heard = {self.default(f"{0x1400 + i:04X}sub1") - 0x180 for i in range(26)}
        told = {(self.default(f"{0x1800 + i:04X}sub1") & 0x7FF) - 0x200 for i in range(31)}
        watched = {self.default(f"1016sub{i:X}") >> 16 for i in range(1, 25)}
        self.assertLessEqual(nodes, heard)
        self.assertLessEqual(nodes, told)
        self.assertEqual(watched - {0}, nodes)


class Drive(Eds.Checks):
    name = "drive.eds"
    product = 1


class Inertial(Eds.Checks):
    name = "inertial.eds"
    product = 0x4B02


class Ankle(Eds.Checks):
    name = "ankle.eds"
    product = 0x4B03


if __name__ == "__main__":
    unittest.main()
