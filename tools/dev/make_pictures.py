#!/usr/bin/python3
"""make_pictures.py [PROGRAM]: runs scenarios and draws all pictures of the robot in README and docs with `koboshi render`, and
those of the studio's window with its test, where that is built.

PROGRAM defaults to build/release/bin/koboshi. Takes a few minutes; call it from anywhere. The seeds are those of the scenarios.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "build/release/bin/koboshi"

# Run: scenario and options of `koboshi run`.
RUNS = {
    "walk": ["scenarios/walk.yaml", "--seed", "1", "--duration", "8"],
    "get_up": ["scenarios/get_up.yaml", "--seed", "1", "--duration", "27"],
    "okiagari": ["scenarios/okiagari.yaml", "--seed", "1"],
}
# Run of a motion: its view and the distance of the camera in m, the instants of its picture in s of the run, and options of `koboshi motion play`. The motion begins
# at 4.5 s.
BALL = "bodies=[{name: ball, diameter_m: 0.065, mass_kg: 0.058, friction: 0.6, rolling_friction: 0.04, position_m: [0.105, %s]}]"
STOOL = "ground.shapes=[{box: {position_m: [-0.111, 0], size_m: [0.1, 0.16, 0.13]}}]"
MOTIONS = {
    "nod": ("front", "1.05", "4.6,5.1,5.4,5.7,6.0"),
    "squat_deep": ("side", "1.05", "5.0,6.0,6.5,7.5,8.8"),
    "one_leg_left": ("front", "1.05", "5.0,6.8,7.4,9.0,14.0"),
    "one_leg_right": ("front", "1.05", "5.0,6.8,7.4,9.0,14.0"),
    "touch_floor": ("side", "1.05", "5.0,6.2,7.2,8.6,10.4"),
    "kick_left": ("side", "1.5", "7.6,8.3,8.5,8.56,8.7,8.9", "--set", BALL % "0.045"),
    "kick_right": ("iso", "1.5", "7.6,8.3,8.5,8.56,8.7,8.9", "--set", BALL % "-0.045"),
    "greet": ("front", "1.05", "4.6,5.2,5.7,6.0,6.3"),
    "push_up": ("side", "1.4", "5.4,6.2,7.1,8.3,9.5", "--set", "initial={attitude_deg: {pitch: 90}}"),
    "sit_down": ("side", "1.05", "5.0,6.2,7.2,8.1,9.4", "--set", STOOL),
    "dance": ("front", "1.05", "6.5,8.9,13.2,17.6,20.5,26.2"),
}
# Picture: run and options of `koboshi render`.
PICTURES = {
    "docs/guide/walk.png": ["walk", "--at", "6.20,6.35,6.50,6.65,6.80", "--overlay", "time,zmp,footprints"],
    "docs/guide/get_up.png": ["get_up", "--at", "18.0,18.4,18.9,19.8,20.4,20.9,21.3,22.2", "--view", "side", "--azimuth", "65",
                              "--size", "340x380", "--overlay", "time"],
    "docs/guide/okiagari.webp": ["okiagari", "--from", "3.5", "--to", "13.5", "--camera", "follow", "--azimuth", "55",
                                 "--size", "640x360", "--fps", "20", "--overlay", "time,events,pushes,footprints"],
}
# Picture: name in the pictures of the test.
STUDIO = {"docs/guide/studio.png": "studio-events.png", "docs/guide/studio-motion.png": "studio-motion.png",
          "docs/guide/studio-soles.png": "soles.png", "docs/guide/studio-onion.png": "onion.png",
          "docs/guide/studio-rings.png": "rings.png",
          "docs/guide/studio-parameters.png": "studio-parameters.png",
          "docs/tutorial/studio-refused.png": "make-refused.png", "docs/tutorial/studio-played.png": "make-played.png",
          "docs/tutorial/studio-model.png": "studio-model.png", "docs/tutorial/studio-model-finding.png": "studio-model-finding.png",
          "docs/tutorial/studio-model-walks.png": "studio-model-walks.png"}


# Program of tests: the tests that save pictures.
STUDIO_TESTS = {"studio_window_test": ["pictures"], "studio_motion_window_test": ["makes_a_motion"],
                "studio_model_window_test": ["pictures"], "studio_tuning_test": ["pictures"],
                "studio_view_test": ["soles_and_zmp_from_above", "shows_the_poses_around_a_step", "rotates_a_foot_by_a_ring"]}


def draw_studio(programs, folder):
    for test, names in STUDIO_TESTS.items():
        subprocess.run([ROOT / "tests/support/with_display.sh", programs / test, *names], check=True, stdout=subprocess.DEVNULL,
                       env=os.environ | {"KOBOSHI_PICTURES": folder})
    for file, picture in STUDIO.items():
        shutil.copyfile(f"{folder}/{picture}", ROOT / file)


def main():
    program = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else PROGRAM
    with tempfile.TemporaryDirectory() as folder:
        for name, arguments in RUNS.items():
            subprocess.run([program, "run", *arguments, "--out", f"{folder}/{name}"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        for name, (view, distance, instants, *options) in MOTIONS.items():
            subprocess.run([program, "motion", "play", f"robots/koboshi/motions/{name}.yaml", *options, "--out", f"{folder}/{name}"],
                           cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
            subprocess.run([program, "render", f"{folder}/{name}", "--out", f"docs/reference/motions/{name}.png", "--at", instants,
                            "--size", "240x280", "--overlay", "time", "--view", view, "--distance", distance], cwd=ROOT, check=True)
        for file, (run, *options) in PICTURES.items():
            subprocess.run([program, "render", f"{folder}/{run}", "--out", file, *options], cwd=ROOT, check=True)
        if all((program.parent / test).exists() for test in STUDIO_TESTS):
            draw_studio(program.parent, folder)


if __name__ == "__main__":
    main()
