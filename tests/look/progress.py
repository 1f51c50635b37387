#!/usr/bin/env python3
"""Checks the pages of studies that run in a browser without a network.

    tests/look/progress.py DROPTOWER --axe axe.min.js [--pictures DIR]

Starts a sweep and a search, takes their pages while they run, stops them, and takes them again. Fails where a page does not renew
itself, loses what its reader chose, goes on when the study has ended or nothing is heard of it, does not lead to its report, or
breaks what tests/look/report.py asks of every page, on a desktop and on a phone.
"""

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from playwright.sync_api import sync_playwright
from report import (
    DESKTOP,
    DRAWN,
    Fault,
    OpenPage,
    expect,
    fits_the_screen,
    is_accessible,
    keyboard_reaches_plots,
    picture,
    plots_are_drawn,
    texts_do_nothing,
    theme_changes,
)

PHONE = {"width": 390, "height": 844}
PATIENCE = 600  # s that a study may take to come as far as is needed

SEARCH = """
let test = scenario(args.scenario);
let options = #{ max_evaluations: 100000, max_iterations: 100000, tol_x: 1e-12, tol_f: 1e-15, names: ["k1", "ke", "ky"],
    title: test.name, signals: ["acceleration (m/s²)", "displacement (m)"] };
log("<b>a message</b>");
minimize("cma-es", [2.0, 3.0, 1.0], options, |k| {
    if k[2] > 1.6 { throw "k2 is beyond its range"; }
    let run = test.with(#{ "specimen.material.fabric.scale": #{ k1: k[0], ke: k[1], ky: k[2] } }).simulate();
    relative_error(run.acceleration, test.reference.acceleration, test.window)
        + relative_error(run.displacement, test.reference.displacement, test.window)
});
"""


def taken(droptower, folder, arguments, page, is_enough):
    """The text of a page while its study runs, twice, and after it was interrupted."""
    process = subprocess.Popen([droptower, *arguments, "--quiet"], cwd=folder)
    begin = time.monotonic()
    texts = []
    while len(texts) < 2:
        expect(process.poll() is None, f"{arguments[0]} ended early")
        expect(time.monotonic() - begin < PATIENCE, f"{page} does not come far enough")
        text = page.read_text() if page.is_file() else ""
        if is_enough(text) and text not in texts:
            texts.append(text)
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    expect(process.wait(PATIENCE) == 1, "an interrupted study ends with status 1")
    stopped = json.loads((page.parent / "stopped.json").read_text())
    expect(stopped["stopped"] is True, "stopped.json does not say so")
    return [*texts, page.read_text()]


def done(text):
    """Number of runs or trials that are done."""
    words = text.split(" done</span><span class=\"value\">")
    return int(words[1].split("<")[0]) if len(words) > 1 else 0


def beat(opened):
    return opened.page.locator(".renewal").get_attribute("data-beat")


def renews_and_keeps(browser, place, texts):
    """What is chosen on a page is chosen on the one that takes its place."""
    place.write_text(texts[0])
    opened = OpenPage(browser, place, DESKTOP, "light")
    page = opened.page
    first = beat(opened)
    page.locator("button.theme").click()
    plot = page.locator("figure.plot").first
    if plot.count():
        plot.locator(".legend button").first.click()
        plot.locator("button[title='zoom in']").click()
    page.locator("button.pause").click()
    page.wait_for_timeout(3500)
    expect(beat(opened) == first, "a page that is held renews itself")
    place.write_text(texts[1])
    page.locator("button.pause").click()
    page.mouse.move(1, 1)
    page.wait_for_function("(first) => document.querySelector('.renewal')?.dataset.beat !== first", arg=first, timeout=60_000)
    page.evaluate(DRAWN)
    expect(page.evaluate("document.documentElement.dataset.theme") == "dark", "the theme is lost")
    if plot.count():
        off = page.locator("figure.plot").first.locator(".legend button").first.get_attribute("aria-pressed")
        expect(off == "false", "a curve that was hidden is shown again")
        expect(page.locator("figure.plot").first.locator("button[title='show everything']").is_enabled(), "the zoom is lost")
    links = page.locator("nav a")
    if links.count():
        links.last.click()
        page.wait_for_timeout(300)
        expect(page.evaluate("location.hash").startswith("#keep"), "a link to a section forgets what was chosen")
    opened.close()


def ends_where_nothing_is_heard(browser, place, text):
    """A page of a process that is gone says since when there is no news."""
    silence = text.replace('data-silence="10"', 'data-silence="0.4"')
    expect(silence != text, "the page does not tell how long a process may be silent")
    place.write_text(silence)
    opened = OpenPage(browser, place, DESKTOP, "light")
    page = opened.page
    page.wait_for_selector(".renewal.silent", timeout=60_000)
    expect("No news since" in page.locator(".renewal").inner_text(), "the page does not say that nothing is heard")
    marked = "window.marked = true"
    page.evaluate(marked)
    page.wait_for_timeout(4000)
    expect(page.evaluate("window.marked") is True, "a page of which nothing is heard renews itself")
    opened.close()


def ends_with_its_study(browser, place, text):
    place.write_text(text)
    opened = OpenPage(browser, place, DESKTOP, "light")
    page = opened.page
    page.evaluate("window.marked = true")
    page.wait_for_timeout(4000)
    expect(page.evaluate("window.marked") is True, "the page of a stopped study renews itself")
    expect("stopped" in page.locator("h1").inner_text(), "the page does not say that the study was stopped")
    opened.close()


def leads_to_the_report(browser, page):
    context = browser.new_context(viewport=DESKTOP, offline=True)
    shown = context.new_page()
    shown.goto(page.as_uri())
    shown.wait_for_url("**/report.html", timeout=60_000)
    expect(shown.locator("main > h1").count() == 1, "the report is not shown")
    context.close()


def examine(browser, name, texts, given, folder):
    place = folder / f"{name}.html"
    for text, state in zip(texts[1:], ("running", "stopped")):
        place.write_text(text.replace('data-lives="true"', 'data-lives="false"'))
        for kind, window, scheme in [("light", DESKTOP, "light"), ("dark", DESKTOP, "dark"), ("phone", PHONE, "light")]:
            opened = OpenPage(browser, place, window, scheme)
            picture(opened, given.pictures, f"progress-{name}-{state}-{kind}")
            plots = plots_are_drawn(opened)
            fits_the_screen(opened)
            texts_do_nothing(opened)
            is_accessible(opened, given.axe)
            if kind == "light":
                theme_changes(opened)
                if plots:
                    keyboard_reaches_plots(opened)
            opened.close()
    renews_and_keeps(browser, place, texts)
    ends_where_nothing_is_heard(browser, place, texts[0])
    ends_with_its_study(browser, place, texts[2])
    return f"{plots} plots, {len(texts[1]) / 1000:.0f} kB"


def main():
    arguments = argparse.ArgumentParser(description="Checks the pages of studies that run.")
    arguments.add_argument("droptower", type=Path, help="the program")
    arguments.add_argument("--axe", type=Path, required=True, help="axe.min.js of axe-core")
    arguments.add_argument("--pictures", type=Path, help="folder for pictures of the pages")
    given = arguments.parse_args()
    if given.pictures:
        given.pictures.mkdir(parents=True, exist_ok=True)
    droptower = str(given.droptower.resolve())
    root = Path(__file__).resolve().parents[2]
    coarse = ["--set", "specimen.mesh.size=80 mm"]
    with tempfile.TemporaryDirectory() as work, sync_playwright() as playwright:
        folder = Path(work)
        (folder / "search.rhai").write_text(SEARCH)
        executable = os.environ.get("CHROMIUM", "/usr/bin/chromium")
        browser = playwright.chromium.launch(executable_path=executable, args=["--no-sandbox", "--disable-gpu"])
        sweep = ["sweep", str(root / "scenarios/drop/scatter.toml"), *coarse]
        search = ["script", "search.rhai", "--scenario", str(root / "scenarios/drop/1008.toml"), *coarse]
        faults = 0
        for name, study, page in [
            ("sweep", [*sweep, "-n", "100000", "--out", "sweep"], folder / ".progress/sweep/progress.html"),
            ("search", [*search, "--out", "search"], folder / ".progress/search/progress.html"),
        ]:
            try:
                texts = taken(droptower, folder, study, page, lambda text: done(text) >= 25)
                print(f"progress of a {name}: {examine(browser, name, texts, given, folder)}")
            except Fault as fault:
                faults += 1
                print(f"progress of a {name}: {fault}", file=sys.stderr)
        try:
            subprocess.run([droptower, *sweep, "-n", "4", "--out", "sweep", "--quiet"], cwd=folder, check=True)
            leads_to_the_report(browser, folder / ".progress/sweep/progress.html")
        except Fault as fault:
            faults += 1
            print(f"the page of a sweep that has ended: {fault}", file=sys.stderr)
        browser.close()
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
