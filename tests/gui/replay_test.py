"""replay_test.py SAMPLE_PAGES: opens replay pages in Chromium without a screen, as a file, and uses them by keyboard and touch.

The pages show a made-up robot (tests/support/walking_recording.h), so they do not depend on the robot, its walk or its meshes. The
pictures in reference/ are compared by structural similarity. `replay_test.py --update SAMPLE_PAGES` writes them anew.
"""

import base64
import io
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import compared_pictures  # noqa: E402
from browser_page import BrowserPage  # noqa: E402

REFERENCE = pathlib.Path(__file__).resolve().parent / "reference"

# The test of the pictures shows that a page without the robot, and one of another time, are less similar than this.
LEAST_SIMILARITY = 0.97

# Opening may take 2 s. Main-thread time, because the wall clock also counts what else runs on the machine.
MOST_OPENING_S = 2.0

DESKTOP = (1400, 900)
PHONE = (390, 844)


# WebGL without a graphics processor; without WebGL, a browser also composes pages without the emulation of such a processor.
WEBGL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
NO_WEBGL = ("--disable-gpu", "--disable-software-rasterizer")


def start_browser(folder, *drawing):
    """Starts Chromium, which keeps its temporary files in the folder: it leaves some behind."""
    options = webdriver.ChromeOptions()
    options.binary_location = "/usr/bin/chromium"
    for argument in ("--headless=new", "--no-sandbox", "--hide-scrollbars",
                     "--force-device-scale-factor=1", "--window-size=1400,900", "--disable-background-networking", *drawing):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    service = Service("/usr/bin/chromedriver", env={**os.environ, "TMPDIR": str(folder)})
    return webdriver.Chrome(service=service, options=options)


class ReplayPage(BrowserPage, unittest.TestCase):
    update = False
    sample_pages = None

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="koboshi_gui_", ignore_cleanup_errors=True)
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        subprocess.run([cls.sample_pages, cls.folder], check=True)
        cls.browser = start_browser(cls.folder, *WEBGL)
        cls.addClassCleanup(cls.browser.quit)

    # --- helpers ---

    def open(self, name, size=DESKTOP, dark=False, touch=False, fragment=""):
        """Opens a page and returns the main thread's time until it was ready, in s."""
        browser = self.browser
        browser.get("about:blank")
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": touch})
        browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": touch})
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                {"features": [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]})
        browser.execute_cdp_cmd("Performance.enable", {"timeDomain": "threadTicks"})
        browser.get(f"file://{self.folder / name}{fragment}")
        deadline = time.monotonic() + 60
        while not self.run_script("return document.body.dataset.ready === 'true'"):
            self.assertEqual(self.run_script("return document.getElementById('failure').textContent"), "")
            self.assertLess(time.monotonic(), deadline, "the page does not become ready")
            time.sleep(0.05)
        metrics = browser.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]
        return {metric["name"]: metric["value"] for metric in metrics}["TaskDuration"]

    def press_with_shift(self, key):
        webdriver.ActionChains(self.browser).key_down(Keys.SHIFT).send_keys(key).key_up(Keys.SHIFT).perform()

    def time_us(self):
        return self.run_script("return koboshi.time")

    def cursor(self):
        """Returns what each part of the page shows of the cursor."""
        return self.run_script("""
            const shown = (id) => document.getElementById(id).textContent;
            const current = document.querySelector("#event-list [aria-current]");
            const frame = document.querySelector("#can-rows [aria-current]");
            const trunk = koboshi.view.robot.links[0].matrixWorld.elements;
            return {time: shown("time"), state: shown("state"), trunkX: trunk[12], plotX: koboshi.plots.panes[0].cursorX,
                    legend: document.querySelector(".legend b").textContent, timelineX: koboshi.timeline.cursorX,
                    slider: document.getElementById("timeline").getAttribute("aria-valuetext"),
                    event: current ? current.textContent : "", frame: frame ? frame.textContent : "",
                    contacts: koboshi.view.balance.now.contacts, pushes: koboshi.view.balance.now.pushes,
                    landed: koboshi.view.balance.footprints.landed, corners: koboshi.view.balance.now.supportCorners};""")

    def picture(self):
        """Returns the page as a grey picture of the compared width."""
        self.run_script("koboshi.view.render(); return 0")
        shot = self.browser.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})["data"]
        return compared_pictures.grey(io.BytesIO(base64.b64decode(shot)))

    def similarity_to(self, name):
        return compared_pictures.similarity(self.picture(), compared_pictures.read(REFERENCE / name))

    def check_picture(self, name):
        if self.update:
            REFERENCE.mkdir(exist_ok=True)
            compared_pictures.save(REFERENCE / name, self.picture())
            return
        similarity = self.similarity_to(name)
        if similarity < LEAST_SIMILARITY:
            compared_pictures.save(pathlib.Path(tempfile.gettempdir()) / name, self.picture())
        self.assertGreaterEqual(similarity, LEAST_SIMILARITY, f"{name} differs from the reference")

    def check_log(self):
        """Fails if the console holds an error, or if anything but the page itself was requested."""
        self.assertEqual([entry["message"] for entry in self.browser.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")], [])
        urls = set()
        for entry in self.browser.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                urls.add(message["params"]["request"]["url"].split("#")[0])
        allowed = {f"file://{self.folder / name}" for name in ("sample.html", "compare.html", "minute.html")} | {"about:blank", "data:,"}
        self.assertLessEqual(urls, allowed)

    def tearDown(self):
        self.check_log()

    # --- tests ---

    def test_cursor_moves_every_part(self):
        self.open("sample.html")
        self.run_script("koboshi.showTab('can')")
        self.run_script("koboshi.setTime(0.3e6)")
        before = self.cursor()
        self.run_script("koboshi.setTime(2.05e6)")
        after = self.cursor()
        self.assertEqual((before["time"], after["time"]), ("0.300 s", "2.050 s"))
        self.assertEqual((before["state"], after["state"]), ("boot", "walking"))
        self.assertEqual(after["slider"], "2.050 s, walking")
        self.assertAlmostEqual(before["trunkX"], 0.03, delta=1e-5)
        self.assertAlmostEqual(after["trunkX"], 0.205, delta=1e-5)
        # The cursor's place in plots and time line follows their axes.
        share = (2.05 - 0.01) / (4.0 - 0.01)
        width = self.run_script("return koboshi.plots.panes[0].canvas.clientWidth")
        self.assertAlmostEqual(after["plotX"], 58 + share * (width - 59), delta=1)
        width = self.run_script("return document.getElementById('timeline').clientWidth")
        self.assertAlmostEqual(after["timelineX"], 8 + share * (width - 16), delta=1)
        self.assertAlmostEqual(float(after["legend"].split()[0].replace("−", "-")), math.degrees(0.05 * math.sin(4.1)), delta=0.001)
        self.assertIn("Command enable", before["event"])
        self.assertIn("A push of 0.5 N s", after["event"])
        self.assertEqual((before["pushes"], after["pushes"]), (0, 1))
        self.assertEqual((before["landed"], after["landed"]), (1, 5))
        self.assertEqual((after["contacts"], after["corners"]), (4, 4))
        self.assertNotEqual(before["frame"], after["frame"])
        self.assertTrue(after["frame"].startswith("2.04"), after["frame"])
        self.check_that_signals_are_added_by_name()
        self.check_colours_and_angles_of_plots()

    def test_frames_are_decoded_and_filtered(self):
        self.open("sample.html")
        self.run_script("koboshi.showTab('can'); koboshi.setTime(1.4905e6)")
        rows = self.run_script("return [...document.querySelectorAll('#can-rows .row:not([hidden])')].map((row) => row.textContent)")
        text = "\n".join(rows)
        self.assertIn("EMCY node 16: 8110", text)
        self.assertRegex(text, r"left_drive_tpdo1: position = −?[0-9.]+ rad, torque = −?\d+ ‰, mode = cyclic synchronous position")
        count = lambda: self.run_script("return koboshi.can.shown.length")
        everything = count()
        self.assertEqual(everything, self.run_script("return koboshi.run.frames.count"))
        box = self.browser.find_element(By.ID, "can-filter")
        filtered = {}
        for words in ("emcy", "right_drive", "0x610", "1016:01", "torque 190"):
            box.clear()
            box.send_keys(words)
            self.run_script("koboshi.can.filter()")
            filtered[words] = count()
        self.assertEqual(filtered, {"emcy": 1, "right_drive": 400, "0x610": 1, "1016:01": 2, "torque 190": 400})
        box.clear()
        self.run_script("koboshi.can.filter()")
        self.browser.find_element(By.XPATH, "//span[@id='can-kinds']/button[text()='PDO']").click()
        self.assertEqual(count(), everything - 800)
        # A click on a row moves the cursor to the frame.
        row = self.browser.find_element(By.CSS_SELECTOR, "#can-rows .row:not([aria-current])")
        frame_s = float(row.text.split()[0])
        row.click()
        self.assertAlmostEqual(1e-6 * self.time_us(), frame_s, delta=1e-6)
        self.check_that_escape_empties_a_filter()

    def test_keyboard(self):
        self.open("sample.html", fragment="#t=1.5")
        self.assertEqual(self.time_us(), 1_500_000)
        self.press(Keys.ARROW_RIGHT)
        self.assertEqual(self.time_us(), 1_510_000)
        self.press(Keys.ARROW_LEFT, Keys.ARROW_LEFT)
        self.assertEqual(self.time_us(), 1_490_000)
        self.press_with_shift(Keys.ARROW_RIGHT)
        self.assertEqual(self.time_us(), 2_490_000)
        self.press(Keys.END)
        self.assertEqual(self.time_us(), 4_000_000)
        self.press(Keys.HOME)
        self.assertEqual(self.time_us(), 10_000)
        self.press("n")
        self.assertEqual(self.time_us(), 500_000)
        settings = "const v = koboshi.view; return [v.follow, v.viewKey, v.robot.links[0].collisions.visible, [...v.robot.materials_.values()][0].transparent]"
        self.assertEqual(self.run_script(settings), [True, "4", False, False])
        self.press("F", "2", "b", "t")
        self.assertEqual(self.run_script(settings), [False, "2", True, True])
        self.press(".", ".", ",")
        self.assertEqual(self.time_us(), 510_000)
        self.press("n", "p")
        self.press("z")
        self.assertEqual(self.run_script("return koboshi.plots.range.to - koboshi.plots.range.from"), 2_000_000)
        self.press("?")
        self.assertTrue(self.run_script("return document.getElementById('help').open"))
        self.press(Keys.ESCAPE)
        self.wait_until("return !document.getElementById('help').open && document.activeElement === document.body")
        self.press("<", "<", "<", " ")
        self.assertEqual(self.run_script("return [koboshi.playing, koboshi.speed]"), [True, 0.1])
        self.wait_until("return koboshi.time > 500000")
        self.press(" ")
        self.assertFalse(self.run_script("return koboshi.playing"))
        self.assertGreater(self.time_us(), 500_000)
        # A key that is typed into a field is text.
        self.browser.find_element(By.ID, "event-filter").click()
        before = self.time_us()
        self.press("n", " ", "f")
        self.assertEqual(self.time_us(), before)
        self.press(Keys.ESCAPE)
        self.check_that_the_camera_stays_above_the_floor()

    # --- checks within the tests: opening a page takes seconds ---

    def check_that_escape_empties_a_filter(self):
        shown = {"events": "return document.querySelectorAll('#event-list li:not([hidden])').length",
                 "signals": "return document.querySelectorAll('#signal-list button:not([hidden])').length",
                 "can": "return koboshi.can.shown.length"}
        for tab, box in (("events", "event-filter"), ("signals", "signal-filter"), ("can", "can-filter")):
            with self.subTest(tab):
                self.run_script(f"koboshi.showTab('{tab}')")
                everything = self.run_script(shown[tab])
                self.browser.find_element(By.ID, box).send_keys("push emcy")
                self.wait_until(f"{shown[tab].replace('return', 'return 1 *')} < {everything}")
                self.press(Keys.ESCAPE)
                self.wait_until(f"{shown[tab].replace('return', 'return 1 *')} === {everything}")
                self.assertEqual(self.run_script(f"return [document.getElementById('{box}').value, document.activeElement.id]"), ["", ""])

    def check_that_signals_are_added_by_name(self):
        box = self.browser.find_element(By.ID, "add-signal")
        note = lambda: self.run_script("const n = document.getElementById('signal-note'); return n.hidden ? '' : n.textContent")
        box.send_keys("no_such_signal", Keys.ENTER)
        self.assertIn("No signal is named “no_such_signal”", note())
        self.press(Keys.ESCAPE)
        self.assertEqual((note(), box.get_attribute("value")), ("", ""))
        box.send_keys("true_", Keys.ENTER)
        self.assertRegex(note(), "“true_” is in the names of [0-9]+ signals")
        self.press(Keys.ESCAPE)
        box.send_keys("left load imu_pitch", Keys.ENTER)
        self.assertIn("No signal", note())

    def check_colours_and_angles_of_plots(self):
        # The recording has not all of these signals: the pane has its own again before the page can draw it.
        places = """
            const pane = koboshi.plots.panes[0];
            const own = pane.names;
            const series = [...arguments].map((names) => { pane.names = names; pane.makeLegend(); return pane.series_; });
            pane.names = own;
            pane.makeLegend();
            return series;"""
        examples = {"planned_zmp_y zmp_y true_zmp_y": [1, 0, 7], "true_left_load true_right_load": [2, 3],
                    "right_load left_load": [3, 2], "left_load right_knee": [0, 1], "left_zmp_y right_zmp_y": [2, 3]}
        self.assertEqual(self.browser.execute_script(places, *[names.split() for names in examples]), list(examples.values()))
        plotted = """
            const signal = Object.assign(Object.create(Object.getPrototypeOf(koboshi.run.signals[0])), {unit: arguments[0]});
            signal.values_ = [3.1, 3.2 - 2 * Math.PI, NaN, 3.3 - 2 * Math.PI, 0.5];
            return [...signal.plotted].map((value) => Number.isFinite(value) ? Math.round(1e6 * value) / 1e6 : null);"""
        self.assertEqual(self.browser.execute_script(plotted, "rad"), [3.1, 3.2, None, 3.3, 0.5])
        self.assertEqual(self.browser.execute_script(plotted, "N"), [3.1, -3.083185, None, -2.983185, 0.5])

    def drag(self, button, by):
        """Drags from the middle of the view."""
        x, y = self.run_script("const b = document.getElementById('canvas3d').getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]")
        for kind, share in (("mousePressed", 0), ("mouseMoved", 0.5), ("mouseMoved", 1), ("mouseReleased", 1)):
            self.browser.execute_cdp_cmd("Input.dispatchMouseEvent", {
                "type": kind, "x": x + share * by[0], "y": y + share * by[1], "button": button, "clickCount": 1,
                "buttons": {"left": 1, "right": 2}[button] if kind != "mouseReleased" else 0})

    def check_that_the_camera_stays_above_the_floor(self):
        heights = lambda: self.run_script("return [koboshi.view.camera.position.z, koboshi.view.controls.target.z]")
        for button, by in (("left", (0, -400)), ("left", (100, -400)), ("right", (0, -400)), ("right", (0, -400)), ("left", (0, -400))):
            self.drag(button, by)
            eye, target = heights()
            self.assertGreaterEqual(eye, 0.0199, (button, by))
            self.assertGreaterEqual(target, -1e-9, (button, by))
        # F shows the robot again.
        self.press("f")
        look = self.run_script("""
            const v = koboshi.view;
            return [v.controls.target.distanceTo(v.robot.links[0].position), v.camera.position.distanceTo(v.controls.target), v.height_]""")
        self.assertLess(look[0], look[2])
        self.assertTrue(2 < look[1] / look[2] < 3.5, look)
        # The list of layers stands below the picture.
        self.assertGreaterEqual(self.run_script("""
            const box = (id) => document.getElementById(id).getBoundingClientRect();
            return box("layers").top - box("canvas3d").bottom"""), -0.5)

    def test_controls_have_names_and_can_be_reached(self):
        self.open("sample.html")
        unnamed = self.run_script("""
            return [...document.querySelectorAll("button, input, select, canvas[tabindex], [role=separator], [role=tabpanel]")]
              .filter((e) => !(e.textContent.trim() || e.title || e.getAttribute("aria-label") || e.getAttribute("aria-labelledby")
                               || (e.labels && e.labels.length)))
              .map((e) => e.outerHTML);""")
        self.assertEqual(unnamed, [])
        reached = set()
        self.run_script("document.activeElement.blur()")
        for _ in range(60):
            self.press(Keys.TAB)
            reached.add(self.run_script("return document.activeElement.id || document.activeElement.className || document.activeElement.tagName"))
        self.assertLessEqual({"canvas3d", "split-x", "add-signal", "split-y", "tab-events", "play", "speed", "timeline"}, reached)

    def test_two_runs(self):
        self.open("compare.html")
        badge = self.browser.find_element(By.ID, "difference")
        self.assertEqual(badge.text, "≠ first difference at 1.500 s")
        self.assertIn("true_pitch is ", badge.get_attribute("title"))
        badge.click()
        self.assertEqual(self.time_us(), 1_500_000)
        poses = self.run_script("return [koboshi.view.robot, koboshi.view.ghost].map((robot) => robot.links[0].quaternion.y)")
        self.assertAlmostEqual(2 * (math.asin(poses[1]) - math.asin(poses[0])), 0.15, delta=1e-3)
        self.assertIn(" | ", self.cursor()["legend"])
        self.run_script("koboshi.setTime(2.05e6)")
        self.check_picture("compare.png")

    def test_a_minute_opens_in_two_seconds(self):
        opening_s = self.open("minute.html")
        print(f"a minute: {(self.folder / 'minute.html').stat().st_size / 1e6:.2f} MB, {opening_s:.2f} s of the main thread, "
              f"{1e-3 * self.run_script('return koboshi.readyMs'):.2f} s by the clock")
        self.assertLess(opening_s, MOST_OPENING_S)
        self.assertEqual(self.run_script("return [koboshi.run.times.length, koboshi.run.signals.length]"), [6000, 147])
        self.run_script("koboshi.showTab('can'); koboshi.setTime(30e6)")
        self.assertEqual(self.run_script("return koboshi.can.shown.length"), 49 * 6_000 + 124)

    def test_pictures(self):
        for name, dark in (("light.png", False), ("dark.png", True)):
            with self.subTest(name):
                self.open("sample.html", dark=dark)
                self.run_script("koboshi.setTime(2.05e6)")
                self.check_picture(name)
                if self.update:
                    continue
                # The comparison notices another time, and a robot that is not drawn.
                self.run_script("koboshi.setTime(3.4e6)")
                self.assertLess(self.similarity_to(name), LEAST_SIMILARITY)
                self.run_script("koboshi.setTime(2.05e6); koboshi.toggleLayer('robot')")
                self.assertLess(self.similarity_to(name), LEAST_SIMILARITY)

    def test_phone(self):
        self.open("sample.html", size=PHONE, touch=True)
        self.run_script("koboshi.setTime(2.05e6)")
        self.assertLessEqual(self.run_script("return document.documentElement.scrollWidth"), PHONE[0])
        overflowing = self.run_script("""
            return [...document.querySelectorAll("footer *, header *, #view .bar *")].filter((e) => e.offsetWidth && e.getBoundingClientRect().right > 390.5)
              .map((e) => e.id || e.tagName);""")
        self.assertEqual(overflowing, [])
        self.check_picture("phone.png")
        # One finger orbits the view.
        before = self.run_script("return koboshi.view.camera.position.toArray()")
        for kind, x in (("touchStart", 150), ("touchMove", 190), ("touchMove", 240), ("touchEnd", None)):
            points = [] if x is None else [{"x": x, "y": 250}]
            self.browser.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        after = self.run_script("return koboshi.view.camera.position.toArray()")
        self.assertGreater(math.dist(before, after), 0.05)
        # A finger on the time line moves the cursor.
        box = self.run_script("const b = document.getElementById('timeline').getBoundingClientRect(); return [b.left, b.top, b.width]")
        for kind in ("touchStart", "touchEnd"):
            points = [{"x": box[0] + box[2] / 2, "y": box[1] + 12}] if kind == "touchStart" else []
            self.browser.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        self.assertAlmostEqual(self.time_us(), 2_005_000, delta=20_000)
        self.check_tabs()
        # In landscape, view and plots are beside each other.
        for size in ((844, 390), (667, 375)):
            with self.subTest(size):
                self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                             {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": True})
                self.wait_until(f"return window.innerWidth === {size[0]}")
                view, plot = self.run_script("""
                    const box = (e) => { const b = e.getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]; };
                    return [box(document.getElementById("stage")), box(koboshi.plots.panes[0].canvas)];""")
                for left, top, right, bottom in (view, plot):
                    self.assertGreater(right - left, 0.35 * size[0])
                    self.assertGreater(bottom - top, 55)
                    self.assertLessEqual(right, size[0] + 0.5)
                    self.assertLessEqual(bottom, self.run_script("return document.querySelector('footer').getBoundingClientRect().top") + 0.5)
        self.check_tabs()

    def check_tabs(self):
        for tab in ("events", "can", "signals", "about", "plots"):
            self.browser.find_element(By.ID, "tab-" + tab).click()
            self.assertTrue(self.browser.find_element(By.ID, tab).is_displayed(), tab)
            self.assertLess(self.run_script("return document.getElementById('side').offsetHeight - window.innerHeight"), 0, tab)


if __name__ == "__main__":
    if sys.argv[1] == "--update":
        ReplayPage.update = True
        del sys.argv[1]
    ReplayPage.sample_pages = sys.argv.pop(1)
    unittest.main()
