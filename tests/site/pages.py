#!/usr/bin/env python3
"""Looks at the pages of a site in a browser without a network.

    tests/site/pages.py SITE [--pictures DIR]

Needs `pip install playwright==1.65.2`; drives the Chromium of the system, or the one that CHROMIUM names.
Fails where a page asks for anything outside of the site, logs a warning, shows a formula or a picture that is not drawn, or is
wider than a phone; where the search finds nothing; and where the button does not change the theme.
"""

import argparse
import os
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

PHONE = {"width": 360, "height": 740}
DESKTOP = {"width": 1280, "height": 900}
# Formulas of theory and methods, and those with a number: fewer means that a document lost them, or that they are not found.
FEWEST_FORMULAS = 600
FEWEST_NUMBERS = 120
# What newcomers look for, and a page that has the answer.
SEARCHES = {
    "hourglass": "docs/theory.html",
    "failure mass": "docs/guide.html",
    "DC accelerometer": "docs/recordings.html",
    "LS-DYNA": "docs/solvers.html",
    "how long": "docs/guide.html",
    "mesh size": "docs/scenarios.html",
}

BROKEN_PICTURES = "Array.from(document.images).filter(image => !image.naturalWidth).map(image => image.src)"
LEFT_TEX = "document.querySelector('main').innerText.includes('\\\\frac') || !!document.querySelector('.katex-error')"
# Formulas on lines of their own that are wider than the text, or so wide that they meet their number.
WIDE_FORMULAS = """Array.from(document.querySelectorAll('.katex-display'))
    .filter(formula => {
        const number = formula.querySelector('.katex-tag')?.getBoundingClientRect().left ?? Infinity;
        const parts = Array.from(formula.querySelectorAll('.katex-html > .katex-base'));
        const right = Math.max(...parts.map(part => part.getBoundingClientRect().right));
        return formula.scrollWidth > formula.clientWidth + 1 || right > number - 4;
    })
    .map(formula => formula.querySelector('annotation').textContent)"""
NUMBERS = "document.querySelectorAll('.katex-tag').length"


class Fault(Exception):
    pass


def expect(condition, message):
    if not condition:
        raise Fault(message)


class Window:
    """A window of the browser in which pages are opened one after the other, and what they did wrong."""

    def __init__(self, browser, site, size, scheme="light"):
        self.site = site
        self.context = browser.new_context(viewport=size, color_scheme=scheme, offline=True)
        self.page = self.context.new_page()
        self.faults = []
        self.page.on("console", self.on_console)
        self.page.on("pageerror", lambda error: self.faults.append(f"error: {error}"))
        self.page.on("request", self.on_request)

    def on_console(self, message):
        if message.type in ("error", "warning"):
            self.faults.append(f"{message.type}: {message.text}")

    def on_request(self, request):
        if not request.url.startswith((self.site.as_uri(), "data:")):
            self.faults.append(f"it requests {request.url}")

    def open(self, name):
        self.page.goto((self.site / name).as_uri())
        self.page.evaluate("document.fonts.ready")
        faults, self.faults = self.faults, []
        expect(not faults, "; ".join(faults))

    def fits(self):
        wide = self.page.evaluate("document.documentElement.scrollWidth - innerWidth")
        expect(wide <= 0, f"it is {wide} pixels wider than the screen")

    def picture(self, folder, name):
        if folder:
            self.page.screenshot(path=str(folder / f"site-{name}.png"))


def content_is_drawn(window):
    broken = window.page.evaluate(BROKEN_PICTURES)
    expect(not broken, f"pictures are missing: {', '.join(broken)}")
    expect(not window.page.evaluate(LEFT_TEX), "a formula is not drawn")
    expect(window.page.locator("main h1").count() > 0, "it has no title")
    return window.page.locator(".katex").count()


def search_finds(window, word, name):
    """Checks that the search for `word` leads to the page `name`."""
    page = window.page
    page.locator("#mdbook-search-toggle").click()
    # Keys, not a value: with its index loaded, the search listens to keys only.
    page.locator("#mdbook-searchbar").press_sequentially(word)
    found = page.locator("#mdbook-searchresults a")
    found.first.wait_for()
    targets = found.evaluate_all("all => all.map(link => link.getAttribute('href'))")
    expect(any(name in target for target in targets), f"the search for {word} finds {targets}")


def theme_changes(window):
    background = "getComputedStyle(document.documentElement).backgroundColor"
    before = window.page.evaluate(background)
    window.page.locator("#mdbook-theme-toggle").click()
    themes = window.page.locator("#mdbook-theme-list button")
    expect(themes.count() == 3, f"there are {themes.count()} themes")
    window.page.locator("#mdbook-theme-coal").click()
    expect(before != window.page.evaluate(background), "the theme does not change")


def examine(browser, site, pictures):
    pages = sorted(str(path.relative_to(site)) for path in site.rglob("*.html"))
    pages = [name for name in pages if name not in ("404.html", "toc.html")]
    formulas, numbers, faults = 0, 0, 0
    for size in (DESKTOP, PHONE):
        window = Window(browser, site, size)
        for name in pages:
            try:
                window.open(name)
                window.fits()
                if size is DESKTOP:
                    formulas += content_is_drawn(window)
                    numbers += window.page.evaluate(NUMBERS)
                    wide = window.page.evaluate(WIDE_FORMULAS)
                    expect(not wide, f"formulas are wider than the page: {'; '.join(wide)}")
            except Fault as fault:
                faults += 1
                print(f"{name}: {fault}", file=sys.stderr)
        window.context.close()
    try:
        expect(formulas >= FEWEST_FORMULAS, f"there are {formulas} formulas")
        expect(numbers >= FEWEST_NUMBERS, f"{numbers} formulas have numbers")
        light = Window(browser, site, DESKTOP)
        light.open("index.html")
        light.picture(pictures, "first")
        for words, name in SEARCHES.items():
            search_finds(light, words, name)
            light.picture(pictures, "search")
            light.open("index.html")
        theme_changes(light)
        dark = Window(browser, site, DESKTOP, "dark")
        for name in ("docs/theory", "docs/results", "reference/impactor", "reference/functions"):
            dark.open(f"{name}.html")
            dark.picture(pictures, f"{Path(name).name}-dark")
    except Fault as fault:
        faults += 1
        print(fault, file=sys.stderr)
    print(f"{len(pages)} pages, {formulas} formulas")
    return faults


def main():
    arguments = argparse.ArgumentParser(description="Looks at the pages of a site in a browser.")
    arguments.add_argument("site", type=Path)
    arguments.add_argument("--pictures", type=Path, help="folder for pictures of some pages")
    given = arguments.parse_args()
    if given.pictures:
        given.pictures.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        executable = os.environ.get("CHROMIUM", "/usr/bin/chromium")
        browser = playwright.chromium.launch(executable_path=executable, args=["--no-sandbox", "--disable-gpu"])
        faults = examine(browser, given.site.resolve(), given.pictures)
        browser.close()
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
