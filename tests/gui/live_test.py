"""live_test.py KOBOSHI: opens the live view of runs in Chromium without a screen, watches the robot move, and drives it."""

import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import unittest

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from replay_test import NO_WEBGL, PHONE, WEBGL, BrowserPage, start_browser

ROOT = pathlib.Path(__file__).resolve().parents[2]
SMALL = (900, 600)  # every picture of a browser without a graphics processor costs time


# Appends batches of 10 s until a run is 150 s long: at each sample one contact and one frame. Looks at the columns.
LONG_RUN = """
    const run = new koboshi.run.constructor({...koboshi.run.json, events: [], pushes: []}, {nodes: [], messages: []}, koboshi.run.bytes, ["NMT"]);
    const [samples, links, signals] = [1000, run.poses.length, run.signals.length];
    for (let batch = 0; batch < 15; ++batch) {
      const columns = [new Float64Array(samples), new Uint8Array(24 * samples), new Float32Array(7 * links * samples),
                       new Float32Array(signals * samples).fill(7), new Uint32Array(samples).fill(1), new Float32Array(8 * samples)];
      const frames = new DataView(columns[1].buffer);
      for (let i = 0; i < samples; ++i) {
        columns[0][i] = 1e4 * (1000 * batch + i + 1);
        frames.setFloat64(24 * i, columns[0][i], true);
        frames.setUint16(24 * i + 14, 65535, true);
        columns[5][8 * i + 2] = 1e-6 * columns[0][i];
      }
      const size = 32 + columns.reduce((sum, column) => sum + column.byteLength, 0);
      const bytes = new Uint8Array(size);
      new Uint32Array(bytes.buffer, 0, 8).set([size, 0, samples, samples, samples, links, signals, 0]);
      let at = 32;
      for (const column of columns) {
        bytes.set(new Uint8Array(column.buffer), at);
        at += column.byteLength;
      }
      run.append(bytes.buffer);
    }
    run.refresh();
    const n = run.times.length;
    const columns = [...run.signals.map((signal) => signal.values), ...run.poses.flatMap((pose) => [...pose.position, ...pose.quaternion])];
    const last = run.contacts.first[n] - 1;
    return {samples: n, span: run.end - run.start, start: run.start, first_frame: run.frames.times[0],
            columns: [...new Set(columns.map((column) => column.length))], contacts: run.contacts.link.length,
            last: [run.value("left_knee_true", n - 1), Math.round(run.contacts.position[0][last])]};"""


class LivePage(BrowserPage, unittest.TestCase):
    patience_s = 60
    program = None

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="koboshi_live_", ignore_cleanup_errors=True)
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        # A browser without a graphics processor spends most of its time on the drawing of the robot, which replay_test.py looks at.
        # Here it has no WebGL: the page has to serve such browsers, too.
        cls.browser = start_browser(cls.folder, *(WEBGL if "KOBOSHI_PICTURES" in os.environ else NO_WEBGL))
        cls.addClassCleanup(cls.browser.quit)

    def start(self, *arguments):
        """Starts the program without a terminal, and opens its page."""
        self.process = subprocess.Popen([self.program, *arguments, "--view"], cwd=ROOT, stdin=subprocess.DEVNULL, text=True,
                                        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self.addCleanup(self.close)
        self.address = re.fullmatch(r"live view on (http://\S+)\n", self.process.stdout.readline())[1]
        self.show(self.address)

    def show(self, address, size=SMALL):
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                     {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": False})
        self.browser.get(address)
        self.wait_until("return document.body.dataset.ready === 'true'")
        self.run_script("window.renderer = koboshi.view.renderer; koboshi.view.renderer = null;")

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()

    def end(self):
        self.process.send_signal(signal.SIGINT)
        self.process.communicate(timeout=60)
        self.assertEqual(self.process.returncode, 0)

    def text(self, name):
        return self.run_script(f"return document.getElementById('{name}').textContent")

    def save_picture(self, name):
        """Saves the page where KOBOSHI_PICTURES says, for somebody to look at it."""
        if "KOBOSHI_PICTURES" not in os.environ:
            return
        self.run_script("koboshi.view.renderer = window.renderer; koboshi.view.render();")
        self.browser.save_screenshot(str(pathlib.Path(os.environ["KOBOSHI_PICTURES"]) / name))
        self.run_script("koboshi.view.renderer = null;")

    def check_log(self):
        self.assertEqual([entry["message"] for entry in self.browser.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")], [])

    def test_follows_the_run_and_drives_the_robot(self):
        self.start("run", "scenarios/teleop.yaml", "--out", str(self.folder / "drive"))
        self.assertEqual(self.text("live-state"), "● live")
        # The cursor follows; the robot moves from its stand into the standing pose.
        knee = "return koboshi.run.value('left_knee_true', koboshi.run.times.length - 1)"
        before_us = self.run_script("return koboshi.time")
        self.wait_until("return document.getElementById('state').textContent === 'standing' && koboshi.time > 3.6e6")
        self.assertGreater(self.run_script("return koboshi.time"), before_us)
        self.assertEqual(self.run_script("return koboshi.following && koboshi.time === koboshi.end"), True)
        trunk_x = self.run_script("return koboshi.view.robot.links[0].position.x")
        self.assertGreater(self.run_script(knee), 0.5)
        self.wait_until("return document.querySelectorAll('#event-list li').length >= 5")
        self.run_script("koboshi.showTab('can')")
        self.wait_until("return koboshi.can.shown && koboshi.can.shown.length === koboshi.run.frames.count")
        # Which frames are shown depends on the moment; each is decoded.
        self.assertRegex(self.text("can-rows"), r"heartbeat|_[RT]PDO\d: \w+ = ")
        # Without the switch, keys are the page's: an arrow steps back, and the page no longer follows.
        self.press(Keys.ARROW_LEFT)
        self.assertEqual(self.run_script("return koboshi.following"), False)
        time_us = self.run_script("return koboshi.time")
        self.wait_until(f"return koboshi.end > {time_us} + 3e5")
        self.assertEqual(self.run_script("return koboshi.time"), time_us)
        self.press(Keys.END)
        self.assertEqual(self.run_script("return koboshi.following"), True)
        # With it they are the robot's.
        self.browser.find_element(By.ID, "drive-switch").click()
        self.press(Keys.ARROW_UP)
        self.wait_until("return document.getElementById('drive-note').textContent.startsWith('key forward: walk, 0.02 m/s forward')")
        self.wait_until("return document.getElementById('state').textContent === 'walking'")
        self.assertEqual(self.run_script("return koboshi.following"), True)
        self.wait_until("return koboshi.view.balance.footprints.landed > 2")
        self.wait_until(f"return Math.abs(koboshi.view.robot.links[0].position.x - {trunk_x}) > 0.005")
        self.press(" ")
        self.wait_until("return document.getElementById('state').textContent === 'standing'")
        self.assertEqual(self.run_script("return koboshi.following"), True)
        self.press(Keys.ESCAPE)
        self.assertEqual(self.text("drive-switch"), "Drive")
        self.check_log()
        self.save_picture("live.png")

        # A page that is opened late, on a phone, knows the past; buttons drive.
        self.show(self.address, PHONE)
        self.assertLess(self.run_script("return koboshi.run.events[0].time"), 1e6)
        self.browser.find_element(By.ID, "drive-switch").click()
        self.run_script("document.getElementById('layers').open = false")
        wide = self.run_script("""
            return [...document.querySelectorAll("footer *, header *, #view .bar *, #drive *")].filter((e) => e.offsetWidth && e.getBoundingClientRect().right > 390.5)
              .map((e) => e.id || e.tagName);""")
        self.assertEqual(wide, [])
        self.save_picture("live-phone.png")
        self.browser.find_element(By.CSS_SELECTOR, "#drive-keys [data-key=e]").click()
        self.wait_until("return document.getElementById('state').textContent === 'emergency stop' || koboshi.timeline.stateAt(koboshi.time) === 'emergency stop'")
        self.end()
        self.wait_until("return document.getElementById('live-state').textContent === '■ the run has ended'")
        self.assertTrue(self.run_script("return document.getElementById('drive-switch').disabled"))
        self.wait_until("return koboshi.run.events.some((event) => event.kind === 'end')")
        self.check_log()
        self.assertIn(" 301#140000000000", (self.folder / "drive" / "can.log").read_text())

    def test_a_board_and_a_lost_connection(self):
        self.start("board")
        self.wait_until("return koboshi.time > 5e5 && koboshi.run.frames.count > 0")
        self.assertFalse(self.browser.find_element(By.ID, "drive").is_displayed())
        self.check_log()
        # The page keeps two minutes of a long run, and its columns still agree.
        kept = self.run_script(LONG_RUN)
        self.assertGreaterEqual(kept["span"], 120e6)
        self.assertLess(kept["span"], 130.1e6)
        self.assertGreater(kept["first_frame"], kept["start"] - 1e6)
        self.assertEqual((kept["columns"], kept["contacts"], kept["last"]), ([kept["samples"]], kept["samples"], [7, 150]))
        self.assertEqual(self.run_script("return koboshi.panel.stream.state"), "live")
        samples = self.run_script("return koboshi.run.times.length")
        self.process.kill()
        self.wait_until("return document.getElementById('live-state').textContent.startsWith('✕ connection lost')")
        self.assertGreaterEqual(self.run_script("return koboshi.run.times.length"), samples)
        self.press(Keys.HOME)
        self.assertEqual(self.run_script("return koboshi.time"), self.run_script("return koboshi.run.start"))
        self.browser.get("about:blank")
        self.browser.get_log("browser")  # the lost connection is an error of the console


if __name__ == "__main__":
    LivePage.program = sys.argv.pop(1)
    unittest.main()
