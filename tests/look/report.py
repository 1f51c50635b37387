#!/usr/bin/env python3
"""Opens report pages in a real browser without a network and looks at them.

    tests/look/report.py PAGE_OR_RUN_FOLDER… [--pictures DIR]

Needs `pip install playwright==1.65.2`; drives the Chromium of the system, or the one that CHROMIUM names.
Fails where a page asks for anything, complains, leaves a plot blank, differs from the summary.json beside it, cannot be
used by keyboard, or is wider than a phone.
"""

import argparse
import json
import os
import re
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

MOST_BYTES = 3_000_000
PHONE = {"width": 360, "height": 740}
DESK = {"width": 1280, "height": 900}

# How many pixels of a canvas differ in colour from its corner.
COLOURED = """canvas => {
    const {width, height} = canvas;
    const data = canvas.getContext("2d").getImageData(0, 0, width, height).data;
    let coloured = 0;
    for (let at = 0; at < data.length; at += 4) {
        const [r, g, b, a] = data.subarray(at, at + 4);
        if (a > 60 && Math.max(r, g, b) - Math.min(r, g, b) > 40) coloured++;
    }
    return coloured;
}"""

PIXELS = "canvas => canvas.toDataURL()"
DRAWN = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done))))"


class Fault(Exception):
    """What is wrong with a page."""


def expect(holds, what):
    if not holds:
        raise Fault(what)


class Look:
    """One page in one window, and everything that it complained about."""

    def __init__(self, browser, path, size, scheme):
        self.context = browser.new_context(viewport=size, color_scheme=scheme, offline=True)
        self.page = self.context.new_page()
        self.complaints = []
        own = path.as_uri()
        self.page.on("console", lambda said: self.hear(said))
        self.page.on("pageerror", lambda error: self.complaints.append(f"error: {error}"))
        self.page.on("request", lambda request: self.asked(request, own))
        self.page.goto(own)
        self.page.evaluate(DRAWN)

    def hear(self, said):
        if said.type in ("error", "warning"):
            self.complaints.append(f"{said.type}: {said.text}")

    def asked(self, request, own):
        # What the page makes itself goes nowhere.
        if request.url.split("#")[0] != own and not request.url.startswith(("blob:", "data:")):
            self.complaints.append(f"the page asks for {request.url}")

    def close(self):
        self.context.close()
        expect(not self.complaints, "; ".join(self.complaints))


def plots_are_drawn(look):
    figures = look.page.locator("figure.plot")
    for at in range(figures.count()):
        figure = figures.nth(at)
        title = figure.locator("h3").inner_text()
        canvas = figure.locator("canvas")
        expect(canvas.count() == 1, f"`{title}` has {canvas.count()} canvases")
        expect(canvas.evaluate(COLOURED) > 10 or only_ink(figure), f"`{title}` is blank")
    return figures.count()


def only_ink(figure):
    """Whether a plot has no coloured curve, only such as stand in ink."""
    return figure.locator(".swatch:not(.dashed)").count() == 0


def film_moves(look):
    film = look.page.locator("figure.film")
    if film.count() == 0:
        return
    canvas, slider = film.locator("canvas"), film.locator("input[type=range]")
    expect(canvas.evaluate(COLOURED) > 500, "the film is blank")
    seen = []
    for end in ("min", "max"):
        slider.evaluate("(slider, end) => { slider.value = slider[end]; slider.dispatchEvent(new Event('input')); }", end)
        look.page.evaluate(DRAWN)
        seen.append(canvas.evaluate(PIXELS))
    expect(seen[0] != seen[1], "the film does not move with its slider")
    canvas.focus()
    look.page.keyboard.press("ArrowLeft")
    look.page.evaluate(DRAWN)
    expect(canvas.evaluate(PIXELS) != seen[1], "the film does not turn with the arrow keys")


def figures_are_those_of(look, summary):
    """Figures of the page that stand in the summary; each as it stands there."""
    marked = look.page.locator("[data-figure]")
    rows = marked.evaluate_all(
        "all => all.map(e => ({...e.dataset, shown: (e.querySelector('.value') ?? e.cells[1]).textContent}))"
    )
    names = set()
    for row in rows:
        name, value, shown = row["figure"], json.loads(row["value"]), row["shown"]
        expect(name in summary, f"`{name}` is on the page and not in summary.json")
        expect(summary[name] == value, f"`{name}`: the page has {value}, summary.json {summary[name]}")
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            expected = value * float(row.get("factor", 1))
            if shown.startswith("< "):
                expect(abs(expected) < float(shown[2:]), f"`{name}`: shown as {shown}, but is {expected}")
                names.add(name)
                continue
            read = float(shown.replace("\u2212", "-"))
            expect(abs(read - expected) <= 6e-4 * abs(expected), f"`{name}`: shown as {shown}, but is {expected}")
        names.add(name)
    numbers = {name for name, value in summary.items() if isinstance(value, (int, float))}
    expect(numbers <= names, f"not on the page: {', '.join(sorted(numbers - names))}")
    return len(names)


def keyboard_reaches_plots(look):
    page = look.page
    first = page.locator("figure.plot .area").first
    page.evaluate("() => { document.activeElement?.blur(); scrollTo(0, 0); }")
    for _ in range(120):
        page.keyboard.press("Tab")
        if first.evaluate("area => area === document.activeElement"):
            break
    else:
        raise Fault("no plot is reached with the tab key")
    ring = first.evaluate("area => getComputedStyle(area).outlineStyle")
    expect(ring not in ("none", ""), "a focused plot shows no ring")
    reading = page.locator("figure.plot .reading").first
    told = []
    page.keyboard.press("Home")
    for _ in range(2):
        page.keyboard.press("ArrowRight")
        page.evaluate(DRAWN)
        told.append(reading.inner_text())
    expect(told[0] and told[0] != told[1], f"arrow keys do not move the cursor: {told}")
    expect(re.search(r"\d", told[1]), f"no value is told: {told[1]}")
    whole = page.locator("figure.plot button[title='show everything']").first
    page.keyboard.press("+")
    expect(whole.is_enabled(), "plus does not zoom")
    page.keyboard.press("Escape")
    expect(whole.is_disabled(), "Escape does not show everything")


def legend_hides_curves(look):
    figure = look.page.locator("figure.plot").first
    before = figure.locator("canvas").evaluate(PIXELS)
    button = figure.locator(".legend button").first
    button.click()
    look.page.evaluate(DRAWN)
    expect(button.get_attribute("aria-pressed") == "false", "the legend does not say what is hidden")
    expect(figure.locator("canvas").evaluate(PIXELS) != before, "the legend hides nothing")
    button.click()


def theme_turns(look):
    before = look.page.evaluate("getComputedStyle(document.body).backgroundColor")
    look.page.locator("button.theme").click()
    after = look.page.evaluate("getComputedStyle(document.body).backgroundColor")
    expect(before != after, "the button does not turn light into dark")
    look.page.locator("button.theme").click()


def fits_the_screen(look):
    wide = look.page.evaluate("document.documentElement.scrollWidth - innerWidth")
    expect(wide <= 0, f"the page is {wide} pixels wider than the screen")


def picture(look, folder, name):
    if folder:
        look.page.evaluate("scrollTo(0, 0)")
        look.page.screenshot(path=str(folder / f"{name}.png"), full_page=True)


def examine(browser, path, name, pictures):
    size = path.stat().st_size
    expect(size < MOST_BYTES, f"the page has {size} bytes")
    beside = path.parent / "summary.json"
    summary = json.loads(beside.read_text()) if beside.is_file() else None

    light = Look(browser, path, DESK, "light")
    picture(light, pictures, f"{name}-light")
    plots = plots_are_drawn(light)
    figures = figures_are_those_of(light, summary) if summary else 0
    film_moves(light)
    theme_turns(light)
    fits_the_screen(light)
    if plots:
        keyboard_reaches_plots(light)
        legend_hides_curves(light)
    first_paint = light.page.evaluate("performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? 0")
    light.close()

    for kind, window, scheme in [("dark", DESK, "dark"), ("phone", PHONE, "light")]:
        look = Look(browser, path, window, scheme)
        picture(look, pictures, f"{name}-{kind}")
        expect(plots_are_drawn(look) == plots, f"{kind}: not all plots are there")
        fits_the_screen(look)
        look.close()
    return f"{plots} plots, {figures} figures, {size / 1000:.0f} kB, first paint after {first_paint:.0f} ms"


def page_of(place):
    path = Path(place).resolve()
    return path / "report.html" if path.is_dir() else path


def main():
    arguments = argparse.ArgumentParser(description="Looks at report pages in a real browser.")
    arguments.add_argument("pages", nargs="+", help="pages, or folders with a report.html")
    arguments.add_argument("--pictures", type=Path, help="folder for pictures of what was seen")
    given = arguments.parse_args()
    if given.pictures:
        given.pictures.mkdir(parents=True, exist_ok=True)
    faults = 0
    with sync_playwright() as playwright:
        executable = os.environ.get("CHROMIUM", "/usr/bin/chromium")
        browser = playwright.chromium.launch(executable_path=executable, args=["--no-sandbox", "--disable-gpu"])
        for place in given.pages:
            path = page_of(place)
            try:
                expect(path.is_file(), "there is no page")
                print(f"{path}: {examine(browser, path, path.parent.name, given.pictures)}")
            except Fault as fault:
                faults += 1
                print(f"{path}: {fault}", file=sys.stderr)
        browser.close()
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
