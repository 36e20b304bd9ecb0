"""studio_pictures_test.py VIEW_TEST: compares pictures of the studio in fixed states with those in reference/.

The program saves each picture, and one of a state that has changed a little: another pose of a leg, a robot 150 ms later, no onion
skin. The changed one must be less similar to the reference than the bound, so that the comparison cannot pass whatever it sees.
`studio_pictures_test.py --update VIEW_TEST` writes the references anew; look at them.
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import compared_pictures  # noqa: E402

REFERENCE = pathlib.Path(__file__).resolve().parent / "reference"
WITH_DISPLAY = pathlib.Path(__file__).resolve().parents[1] / "support" / "with_display.sh"
NAMES = ("studio-pose", "studio-walk", "studio-motion")

# Measured on llvmpipe: 0.9997 to 0.9999 for the same states, 0.963, 0.922 and 0.721 for the changed ones.
LEAST_SIMILARITY = 0.985


class StudioPictures(unittest.TestCase):
    view_test = ""
    update = False

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        subprocess.run([WITH_DISPLAY, cls.view_test, "reference_pictures"], check=True, stdout=subprocess.DEVNULL,
                       env=os.environ | {"KOBOSHI_REFERENCE": cls.folder.name}, timeout=120)

    def picture(self, name):
        return compared_pictures.grey(f"{self.folder.name}/{name}.png")

    def test_pictures_look_as_their_references(self):
        for name in NAMES:
            reference = REFERENCE / f"{name}.png"
            if self.update:
                compared_pictures.save(reference, self.picture(name))
            similarity = compared_pictures.similarity(self.picture(name), compared_pictures.read(reference))
            print(f"{name}: {similarity:.4f}")
            if similarity < LEAST_SIMILARITY:
                compared_pictures.save(pathlib.Path(tempfile.gettempdir()) / f"{name}.png", self.picture(name))
            self.assertGreaterEqual(similarity, LEAST_SIMILARITY, f"{name} differs from the reference")

    def test_changed_states_are_noticed(self):
        for name in NAMES:
            similarity = compared_pictures.similarity(self.picture(f"{name}-changed"), compared_pictures.read(REFERENCE / f"{name}.png"))
            print(f"{name}, changed: {similarity:.4f}")
            self.assertLess(similarity, LEAST_SIMILARITY, f"{name}: the change is not noticed")


if __name__ == "__main__":
    StudioPictures.update = "--update" in sys.argv
    StudioPictures.view_test = sys.argv[-1]
    unittest.main(argv=sys.argv[:1])
