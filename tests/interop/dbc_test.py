"""dbc_test.py DBC ROBOT DECODE_LOG LOG...: canmatrix accepts the DBC and decodes every frame of the logs to the same values as
our own decoder."""

import collections
import pathlib
import subprocess
import sys
import unittest
import warnings

import can

warnings.simplefilter("ignore")  # canmatrix 0.9.5 compares strings by `is`
import canmatrix.formats  # noqa: E402

DBC, ROBOT, DECODE_LOG, *LOGS = sys.argv[1:]
MATRIX = canmatrix.formats.loadp(DBC)[""]
FRAMES = {frame.arbitration_id.id: frame for frame in MATRIX.frames}


def our_readings(log):
    """Returns our decoder's {signal: (raw, value, name)} by frame number."""
    readings = collections.defaultdict(dict)
    output = subprocess.run([DECODE_LOG, ROBOT, log], check=True, capture_output=True, text=True).stdout
    for line in output.splitlines():
        number, signal, raw, value, name = line.split("\t")
        readings[int(number)][signal] = (int(raw), float(value), name)
    return readings


def their_readings(message):
    decoded = FRAMES[message.arbitration_id].decode(bytes(message.data))
    return {name: (signal.raw_value, float(signal.phys_value), signal.signal.values.get(signal.raw_value, ""))
            for name, signal in decoded.items()}


class Dbc(unittest.TestCase):
    maxDiff = None

    def test_has_every_node_and_message(self):
        self.assertEqual(len(MATRIX.ecus), 25)
        for identifier in (0x000, 0x080, 0x081, 0x181, 0x190, 0x1A3, 0x1A4, 0x201, 0x223, 0x5A6, 0x601, 0x726):
            self.assertIn(identifier, FRAMES)
        self.assertEqual(FRAMES[0x080].size, 0)

    def test_tells_times_units_and_names(self):
        answer = FRAMES[0x190]
        self.assertEqual((answer.name, answer.transmitters, answer.cycle_time), ("left_hip_yaw_TPDO1", ["left_hip_yaw"], 10))
        position = answer.signal_by_name("position_actual_value")
        self.assertEqual((position.unit, position.factor, position.receivers), ("deg", 360 / 2**20, ["controller"]))
        self.assertTrue(position.is_signed)
        self.assertEqual(answer.signal_by_name("statusword").values[0x1237], "operation enabled")
        self.assertEqual(FRAMES[0x701].cycle_time, 20)
        self.assertEqual(MATRIX.ecu_by_name("head_tilt").attributes["NodeId"], "35")

    def test_decodes_logs_as_we_do(self):
        for log in LOGS:
            ours = our_readings(log)
            seen = set()
            for number, message in enumerate(can.CanutilsLogReader(log)):
                frame = FRAMES[message.arbitration_id]
                if message.dlc != frame.size:
                    continue  # canmatrix only decodes complete frames
                seen.add(message.arbitration_id)
                with self.subTest(log=log, frame=number):
                    theirs = their_readings(message)
                    self.assertEqual(theirs.keys(), ours[number].keys())
                    for signal, (raw, value, name) in theirs.items():
                        self.assertEqual((raw, name), (ours[number][signal][0], ours[number][signal][2]), signal)
                        self.assertAlmostEqual(value, ours[number][signal][1], delta=1e-9 * max(1.0, abs(value)))
            self.assertGreater(len(seen), 50, pathlib.Path(log).name)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
