#!/usr/bin/python3
"""draw_replay.py PAGE.html|ADDRESS OUT.png [--size=WIDTHxHEIGHT] [--dark] [--time=SECONDS] [--script=JAVASCRIPT] [--wait=SECONDS]:
takes a picture of a replay page, or of the live view at an address.

For pictures in the documentation; needs the packages of packages-gui.txt. The script may use `koboshi`, the page's object. The pictures
of docs/guide/replay.md:

    koboshi run scenarios/okiagari.yaml --out runs/okiagari && koboshi replay runs/okiagari --html
    draw_replay.py runs/okiagari/replay.html docs/guide/replay.png --time=7.05 --script="koboshi.showTab('can'); koboshi.plots.showTwoSeconds()"
    draw_replay.py runs/okiagari/replay.html docs/guide/replay-phone.png --size=390x844 --dark --time=6

Those of docs/tutorial/why-did-it-fall.md, whose steps 3 and 7 make the runs (left-foot.png: the page without --with):

    draw_replay.py runs/fell/replay.html docs/tutorial/first-difference.png --time=4.86 --script="
      const kept = ['true_pitch', 'true_left_load', 'true_right_load'];
      for (const pane of [...koboshi.plots.panes])
        for (const name of [...pane.names]) if (!kept.includes(name)) koboshi.plots.toggle(name);
      koboshi.plots.toggle('true_left_sole_x'); koboshi.plots.toggle('true_right_sole_x');
      koboshi.plots.showTwoSeconds(); koboshi.view.look('2')"

The one of docs/guide/live-view.md, beside `koboshi run scenarios/teleop.yaml --view`, which prints the address. Without a graphics
processor a picture takes most of a second, so the page draws one every two seconds until its last:

    draw_replay.py ADDRESS docs/guide/live.png --size=1400x764 --wait=16 --script="
      const draw = koboshi.view.render.bind(koboshi.view);
      let last = 0;
      koboshi.view.render = () => {
        if (performance.now() - last < 2000) return;
        draw();
        last = performance.now();
      };
      document.getElementById('drive-switch').click();
      for (let i = 0; i < 4; ++i) setTimeout(() => document.querySelector('#drive-keys button').click(), 6000 + 300 * i);
      setTimeout(() => { koboshi.view.render = draw; }, 15000)"
"""

import argparse
import base64
import io
import pathlib
import time

import PIL.Image
from selenium import webdriver
from selenium.webdriver.chrome.service import Service


def parse_arguments():
    parser = argparse.ArgumentParser(description="Takes a picture of a replay page.")
    parser.add_argument("page", help="file of a replay page, or http address of a live view")
    parser.add_argument("picture", type=pathlib.Path)
    parser.add_argument("--size", default="1400x900")
    parser.add_argument("--dark", action="store_true")
    parser.add_argument("--time", type=float, default=0.0, help="in s")
    parser.add_argument("--script", default="")
    parser.add_argument("--wait", type=float, default=0.0, help="after the script, in s")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    width, height = map(int, arguments.size.split("x"))
    options = webdriver.ChromeOptions()
    options.binary_location = "/usr/bin/chromium"
    for argument in ("--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars"):
        options.add_argument(argument)
    browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
    try:
        theme = "dark" if arguments.dark else "light"
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": theme}]})
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 760})
        is_live = arguments.page.startswith("http")
        browser.get(arguments.page if is_live else f"{pathlib.Path(arguments.page).resolve().as_uri()}#t={arguments.time}")
        while browser.execute_script("return document.body.dataset.ready !== 'true'"):
            time.sleep(0.1)
        browser.execute_script(arguments.script)
        time.sleep(arguments.wait)
        browser.execute_script("koboshi.view.render()")
        shot = browser.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})["data"]
        # A palette halves the size of the file.
        PIL.Image.open(io.BytesIO(base64.b64decode(shot))).convert("RGB").quantize(256).save(arguments.picture, optimize=True)
    finally:
        browser.quit()


if __name__ == "__main__":
    main()
