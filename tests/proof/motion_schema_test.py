"""Checks docs/reference/motion.schema.json on all shipped motions, the examples of the language's page, and bad files."""

import copy
import json
import pathlib
import re
import unittest

import jsonschema
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
VALIDATOR = jsonschema.Draft7Validator(json.loads((ROOT / "docs/reference/motion.schema.json").read_text()))
GOOD = yaml.safe_load("""
version: 2
robot: koboshi
name: a
variables: {x: 0}
poses: {p: {knee: 5, from: q}, q: {others: zero}}
steps:
  - {pose: p, time_s: 1}
  - {pose: p, at_least_s: 0.2, interpolation: trapezoid}
  - {loop: {while: x < 5, steps: [{set: {x: "+= 1"}}, {wait_s: 1}]}}
""")

BAD = {
    "an unknown key": lambda motion: motion.update(exitt="a"),
    "no steps": lambda motion: motion.pop("steps"),
    "an unknown version": lambda motion: motion.update(version=3),
    "version 2 in version 1": lambda motion: motion.update(version=1),
    "a long name": lambda motion: motion.update(name="n" * 25),
    "a misspelt step": lambda motion: motion["steps"].append({"wiat_s": 1}),
    "a time out of range": lambda motion: motion["steps"].append({"wait_s": 61}),
    "time and speed": lambda motion: motion["steps"][0].update(speed_deg_per_s=5),
    "time and least time": lambda motion: motion["steps"][0].update(at_least_s=0.2),
    "neither time nor speed": lambda motion: motion["steps"][0].pop("time_s"),
    "a text for an angle": lambda motion: motion["poses"]["p"].update(knee="bent"),
    "two ends of a loop": lambda motion: motion["steps"][2]["loop"].update(times=5),
    "an interpolation that is not there": lambda motion: motion.update(interpolation="spline"),
    "too much stiffness": lambda motion: motion["steps"].append({"stiffness": {"knee": 101}}),
    "an unknown path": lambda motion: motion["steps"][0].update(path="com"),
    "one time of a joint": lambda motion: motion["steps"][0].update(during={"knee": [0.5]}),
    "no gain": lambda motion: motion["steps"].append({"gain": {"knee": 0}}),
    "too much gain": lambda motion: motion["steps"][0].update(gain={"knee": 201}),
    "a word that is no step": lambda motion: motion["steps"].append("halt"),
}


class MotionSchema(unittest.TestCase):
    def test_accepts_shipped_motions(self):
        motions = sorted((ROOT / "robots/koboshi/motions").glob("*.yaml"))
        self.assertGreaterEqual(len(motions), 12)
        for motion in motions:
            with self.subTest(motion=motion.name):
                VALIDATOR.validate(yaml.safe_load(motion.read_text()))

    def test_accepts_the_examples_of_the_language(self):
        page = (ROOT / "docs/reference/motion-language.md").read_text()
        examples = re.findall(r"^```yaml\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
        self.assertGreaterEqual(len(examples), 3)
        for example in examples:
            VALIDATOR.validate(yaml.safe_load(example))

    def test_refuses_bad_motions(self):
        VALIDATOR.validate(GOOD)
        for what, spoil in BAD.items():
            with self.subTest(what=what):
                motion = copy.deepcopy(GOOD)
                spoil(motion)
                self.assertFalse(VALIDATOR.is_valid(motion))


if __name__ == "__main__":
    unittest.main()
