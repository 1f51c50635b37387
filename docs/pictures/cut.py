#!/usr/bin/env python3
"""Cuts the pictures of the gallery out of report pages and reduces their palette.

    cut.py RESULTS PICTURES            # folders of docs/pictures/make
    cut.py --small PICTURE SMALL       # one picture with a reduced palette
"""

import os
import sys
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

COLOURS = 255
# Name, run, what is cut out, and the time in ms at which the film is shown.
CUTS = [
    ("drop", "drop", "figure.film", 57.3),
    ("acceleration", "drop", "figure.plot:has(h3:text-is('Acceleration of the impactor'))", None),
    ("rupture", "rupture", "figure.film", 60.0),
    ("stretch", "stretch", "figure.film", None),
    ("inflation", "inflation", "figure.film", None),
    ("dart", "dart", "figure.film", 26.0),
    ("comparison", "comparison", "figure.plot:has(h3:text-matches('^Acceleration filtered'))", None),
    ("identify", "identify", "figure.plot:has(h3:text-matches('acceleration$'))", None),
]

MOVE = """(slider, time) => {
    const last = slider.max;
    slider.value = time === null ? last : Math.min(time, last);
    slider.dispatchEvent(new Event('input'));
}"""


def small(source, target):
    Image.open(source).convert("RGB").quantize(COLOURS, kmeans=2).save(target, optimize=True)


def cut(browser, results, pictures):
    for name, run, selector, time in CUTS:
        page = browser.new_page(viewport={"width": 900, "height": 900})
        page.goto((results / run / "report.html").resolve().as_uri())
        figure = page.locator(selector).first
        slider = figure.locator("input[type=range]")
        if slider.count():
            slider.evaluate(MOVE, time)
        page.wait_for_timeout(400)
        shot = results / f"{name}.png"
        figure.screenshot(path=str(shot))
        small(shot, pictures / f"{name}.png")
        page.close()


def main():
    if sys.argv[1] == "--small":
        small(sys.argv[2], sys.argv[3])
        return
    results, pictures = map(Path, sys.argv[1:])
    with sync_playwright() as playwright:
        executable = os.environ.get("CHROMIUM", "/usr/bin/chromium")
        browser = playwright.chromium.launch(executable_path=executable, args=["--no-sandbox", "--disable-gpu"])
        cut(browser, results, pictures)
        browser.close()


if __name__ == "__main__":
    main()
