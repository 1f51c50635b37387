#!/usr/bin/env python3
"""Checks report pages in a browser without a network.

    tests/look/report.py PAGE_OR_RUN_FOLDER… --axe axe.min.js [--brief NAME…] [--pictures DIR]

Needs `pip install playwright==1.65.2`; drives the Chromium of the system, or the one that CHROMIUM names.
Fails where a page makes a request or logs a warning, a plot is blank, a figure differs from the summary.json beside it, a
control does not work by keyboard, the page is wider than a phone, anything scrolls sideways on a desktop, or axe-core finds a
violation of WCAG 2 A or AA, such as too little contrast, in light or dark. A brief page also answers at its top, and is
printed on two pages of A4.
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
DESKTOP = {"width": 1280, "height": 900}

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
    """A check that failed."""


def expect(holds, what):
    if not holds:
        raise Fault(what)


class OpenPage:
    """A page in a window, with its requests, warnings and errors."""

    def __init__(self, browser, path, size, scheme):
        self.context = browser.new_context(viewport=size, color_scheme=scheme, offline=True)
        self.page = self.context.new_page()
        self.faults = []
        own = path.as_uri()
        self.page.on("console", self.on_console)
        self.page.on("dialog", lambda dialog: self.faults.append(f"dialog: {dialog.message}"))
        self.page.on("pageerror", lambda error: self.faults.append(f"error: {error}"))
        self.page.on("request", lambda request: self.on_request(request, own))
        self.page.goto(own)
        self.page.evaluate(DRAWN)

    def on_console(self, message):
        if message.type in ("error", "warning"):
            self.faults.append(f"{message.type}: {message.text}")

    def on_request(self, request, own):
        # Objects that the page makes itself are not requested from anywhere.
        if request.url.split("#")[0] != own and not request.url.startswith(("blob:", "data:")):
            self.faults.append(f"the page requests {request.url}")

    def close(self):
        self.context.close()
        expect(not self.faults, "; ".join(self.faults))


def plots_are_drawn(opened):
    figures = opened.page.locator("figure.plot")
    for at in range(figures.count()):
        figure = figures.nth(at)
        title = figure.locator("h3").inner_text()
        canvas = figure.locator("canvas")
        expect(canvas.count() == 1, f"`{title}` has {canvas.count()} canvases")
        expect(canvas.evaluate(COLOURED) > 10 or only_ink(figure), f"`{title}` is blank")
    return figures.count()


def only_ink(figure):
    """Whether no curve of a plot has a colour."""
    return figure.locator(".swatch:not(.dashed)").count() == 0


def film_moves(opened):
    film = opened.page.locator("figure.film")
    if film.count() == 0:
        return
    canvas, slider = film.locator("canvas"), film.locator("input[type=range]")
    expect(canvas.evaluate(COLOURED) > 500, "the film is blank")
    seen = []
    for end in ("min", "max"):
        slider.evaluate("(slider, end) => { slider.value = slider[end]; slider.dispatchEvent(new Event('input')); }", end)
        opened.page.evaluate(DRAWN)
        seen.append(canvas.evaluate(PIXELS))
    expect(seen[0] != seen[1], "the film does not move with its slider")
    canvas.focus()
    opened.page.keyboard.press("ArrowLeft")
    opened.page.evaluate(DRAWN)
    expect(canvas.evaluate(PIXELS) != seen[1], "the arrow keys do not rotate the film")


def figures_are_those_of(opened, summary):
    """Checks that the page has the figures of the summary with their values."""
    marked = opened.page.locator("[data-figure]")
    rows = marked.evaluate_all(
        "all => all.map(e => ({...e.dataset, shown: (e.querySelector('.value') ?? e.cells[1]).textContent}))"
    )
    names = set()
    for row in rows:
        name, value, shown = row["figure"], json.loads(row["value"]), row["shown"]
        expect(name in summary, f"`{name}` is on the page, but not in summary.json")
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


def texts_do_nothing(opened):
    """Whatever a title, a name or a message says is shown as text, and turns or steers nothing."""
    expect(opened.page.evaluate("() => window.hacked") is None, "a text of a file was run")
    text = opened.page.evaluate("() => document.title + document.body.textContent")
    steering = re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]", text)
    expect(not steering, f"the page has the character {steering and hex(ord(steering[0]))}")


def keyboard_reaches_plots(opened):
    page = opened.page
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
    readings = []
    page.keyboard.press("Home")
    for _ in range(2):
        page.keyboard.press("ArrowRight")
        page.evaluate(DRAWN)
        readings.append(reading.inner_text())
    expect(readings[0] and readings[0] != readings[1], f"arrow keys do not move the cursor: {readings}")
    expect(re.search(r"\d", readings[1]), f"the reading has no value: {readings[1]}")
    whole = page.locator("figure.plot button[title='show everything']").first
    page.keyboard.press("+")
    expect(whole.is_enabled(), "plus does not zoom")
    page.keyboard.press("Escape")
    expect(whole.is_disabled(), "Escape does not show everything")


def legend_hides_curves(opened):
    figure = opened.page.locator("figure.plot").first
    before = figure.locator("canvas").evaluate(PIXELS)
    button = figure.locator(".legend button").first
    button.click()
    opened.page.evaluate(DRAWN)
    expect(button.get_attribute("aria-pressed") == "false", "the legend does not show what is hidden")
    expect(figure.locator("canvas").evaluate(PIXELS) != before, "the legend hides nothing")
    button.click()


def theme_changes(opened):
    before = opened.page.evaluate("getComputedStyle(document.body).backgroundColor")
    opened.page.locator("button.theme").click()
    after = opened.page.evaluate("getComputedStyle(document.body).backgroundColor")
    expect(before != after, "the button does not change the theme")
    opened.page.locator("button.theme").click()


def scrolls_nothing_sideways(opened):
    """On a desktop no table and no text is wider than its place, also where it is folded."""
    wide = opened.page.evaluate("""() => {
        document.querySelectorAll("details").forEach((fold) => (fold.open = true));
        const wide = [...document.querySelectorAll(".scroll, pre")].filter((box) => box.scrollWidth > box.clientWidth + 1);
        return wide.map((box) => box.closest("section")?.querySelector("h2")?.textContent ?? box.className);
    }""")
    expect(not wide, f"scrolls sideways: {', '.join(wide)}")


def is_accessible(opened, axe):
    """WCAG 2 A and AA, contrast among them, with all that is folded open."""
    opened.page.evaluate(axe.read_text() + "; undefined")
    opened.page.evaluate("document.querySelectorAll('details').forEach((fold) => (fold.open = true))")
    found = opened.page.evaluate("() => axe.run(document, {runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa']})")
    expect(found["passes"], "axe-core checked nothing")
    said = [f"{one['id']} at {one['nodes'][0]['html'][:120]} ({len(one['nodes'])} places)" for one in found["violations"]]
    expect(not said, f"axe-core: {'; '.join(said)}")


def tables_are_sorted_and_filtered(opened):
    """The head of a column sorts the rows by their numbers, and a field leaves those that have a text."""
    page = opened.page
    page.evaluate("document.querySelectorAll('details').forEach((fold) => (fold.open = true))")
    tables = page.locator("table.sorted")
    for at in range(tables.count()):
        table = tables.nth(at)
        head = table.locator("th.number button").first
        if head.count() == 0:
            continue
        column = head.evaluate("button => button.closest('th').cellIndex")
        numbers = f"table => [...table.tBodies[0].rows].map((row) => row.cells[{column}]?.dataset.sort).filter((n) => n).map(Number)"
        head.focus()
        for key, sign in (("Enter", 1), ("Enter", -1)):
            page.keyboard.press(key)
            found = table.evaluate(numbers)
            expect(found == sorted(found, reverse=sign < 0), f"a column is not sorted: {found[:5]}")
    fields = page.locator(".filter input")
    if fields.count():
        fields.first.fill("no row has this text")
        left = page.locator(".filter + .scroll table").first.evaluate("table => [...table.tBodies[0].rows].filter((row) => !row.hidden).length")
        expect(left == 0, f"a filter leaves {left} rows")
        fields.first.fill("")
    return tables.count()


def answers_first(opened):
    """A sentence and, below the warnings, a picture stand above all tables, and the whole is printed on two pages of A4."""
    page = opened.page
    lead = page.locator("h1 + .lead")
    expect(lead.count() == 1 and re.search(r"\d", lead.inner_text()), "the page does not begin with an answer")
    picture, table = (page.locator(what).first for what in ("figure.plot, .ranges", "table"))
    below = lambda what: what.evaluate("element => element.getBoundingClientRect().top + scrollY")
    expect(picture.count() == 1, "there is no picture")
    warned = page.locator(".warnings").evaluate_all(
        "(boxes, top) => boxes.filter((box) => box.getBoundingClientRect().top + scrollY < top).reduce((sum, box) => sum + box.offsetHeight, 0)",
        below(picture),
    )
    expect(below(picture) - warned < 700, "no picture is seen at once")
    expect(table.count() == 0 or below(picture) < below(table) or not table.is_visible(), "a table stands above the picture")
    pages = len(re.findall(rb"/Type\s*/Page\b", page.pdf(format="A4")))
    expect(pages <= 2, f"it is printed on {pages} pages")


def fits_the_screen(opened):
    wide = opened.page.evaluate("document.documentElement.scrollWidth - innerWidth")
    expect(wide <= 0, f"the page is {wide} pixels wider than the screen")


def picture(opened, folder, name):
    if folder:
        opened.page.evaluate("scrollTo(0, 0)")
        opened.page.screenshot(path=str(folder / f"{name}.png"), full_page=True)


def examine(browser, path, name, given):
    size = path.stat().st_size
    expect(size < MOST_BYTES, f"the page has {size} bytes")
    beside = path.parent / "summary.json"
    summary = json.loads(beside.read_text()) if beside.is_file() else None

    pictures = given.pictures
    light = OpenPage(browser, path, DESKTOP, "light")
    picture(light, pictures, f"{name}-light")
    if name in given.brief:
        answers_first(light)
    plots = plots_are_drawn(light)
    figures = figures_are_those_of(light, summary) if summary else 0
    film_moves(light)
    theme_changes(light)
    fits_the_screen(light)
    texts_do_nothing(light)
    if plots:
        keyboard_reaches_plots(light)
        legend_hides_curves(light)
    tables_are_sorted_and_filtered(light)
    scrolls_nothing_sideways(light)
    is_accessible(light, given.axe)
    first_paint = light.page.evaluate("performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? 0")
    light.close()

    for kind, window, scheme in [("dark", DESKTOP, "dark"), ("phone", PHONE, "light")]:
        opened = OpenPage(browser, path, window, scheme)
        picture(opened, pictures, f"{name}-{kind}")
        expect(plots_are_drawn(opened) == plots, f"{kind}: plots are missing")
        fits_the_screen(opened)
        is_accessible(opened, given.axe)
        fits_the_screen(opened)
        opened.close()
    return f"{plots} plots, {figures} figures, {size / 1000:.0f} kB, first paint after {first_paint:.0f} ms"


def page_of(place):
    path = Path(place).resolve()
    return path / "report.html" if path.is_dir() else path


def main():
    arguments = argparse.ArgumentParser(description="Checks report pages in a browser.")
    arguments.add_argument("pages", nargs="+", help="pages, or folders with a report.html")
    arguments.add_argument("--axe", type=Path, required=True, help="axe.min.js of axe-core")
    arguments.add_argument("--brief", nargs="*", default=[], help="names of pages that answer at their top, on two pages of A4")
    arguments.add_argument("--pictures", type=Path, help="folder for pictures of the pages")
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
                print(f"{path}: {examine(browser, path, path.parent.name, given)}")
            except Fault as fault:
                faults += 1
                print(f"{path}: {fault}", file=sys.stderr)
        browser.close()
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
