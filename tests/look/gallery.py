#!/usr/bin/env python3
"""Pictures of the first screen of each kind of page, on a desktop and a phone, for docs/gallery.md.

    tests/look/gallery.py PAGE_OR_FOLDER… --pictures DIR

Needs `pip install playwright==1.65.2 pillow==13.0.0`; drives the Chromium of the system, or the one that CHROMIUM names. A picture has
the name of the page's folder.
"""

import argparse
import io
import os
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

WINDOWS = {"1280": {"width": 1280, "height": 800}, "390": {"width": 390, "height": 844}}
DRAWN = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done))))"


def main():
    arguments = argparse.ArgumentParser(description="Pictures of pages for the gallery.")
    arguments.add_argument("pages", nargs="+", type=Path, metavar="PAGE_OR_FOLDER")
    arguments.add_argument("--pictures", type=Path, required=True, help="folder of the pictures")
    arguments.add_argument("--whole", action="store_true", help="the whole page, not its first screen alone")
    given = arguments.parse_args()
    given.pictures.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        executable = os.environ.get("CHROMIUM", "/usr/bin/chromium")
        browser = playwright.chromium.launch(executable_path=executable, args=["--no-sandbox", "--disable-gpu"])
        for place in given.pages:
            page = place / "report.html" if place.is_dir() else place
            for width, window in WINDOWS.items():
                context = browser.new_context(viewport=window, color_scheme="light", offline=True)
                shown = context.new_page()
                shown.goto(page.resolve().as_uri())
                shown.evaluate(DRAWN)
                taken = Image.open(io.BytesIO(shown.screenshot(full_page=given.whole))).convert("RGB")
                taken.save(given.pictures / f"{page.parent.name}-{width}.webp", quality=70, method=6)
                context.close()
        browser.close()


if __name__ == "__main__":
    main()
