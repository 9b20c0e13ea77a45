#!/usr/bin/env python3
"""Measures the script time per frame of a page with two robots and their source, over a minute of motion.

    bench/page_callback.py build/release/tools/retarget/retarget dance.bvh [--robot NAME] [--size 1280x720]

makes two motions of the first minute (published method and fit), plays their page in headless Chromium at four
times the speed, traces it, and prints the median and the 95th percentile of the duration of the
requestAnimationFrame callback in milliseconds: as wall-clock time, and as thread time, which other programs do not
affect. Another process renders WebGL on the processor (SwiftShader), so the callback is only the script. Needs
Chromium, but no window and no graphics card."""

import argparse
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests/cli"))
from browser import Browser, chromium

SPEED = 4.0
CALLBACK = "FireAnimationFrame"


def make_page(tool, clip, robot, folder):
    """Makes a page with two motions of a clip's first minute and the source."""

    def run(*arguments):
        subprocess.run([tool, *map(str, arguments), "--quiet"], check=True)

    motions = []
    for method in ("gmr", "fit"):
        motions.append(folder / f"{method}.csv")
        run("--bvh", clip, "--robot", robot, "--method", method, "--end", 60, "-o", motions[-1])
    page = folder / "both.html"
    run("view", *motions, "--robot", robot, "--bvh", clip, "-o", page)
    return page


def trace(browser, seconds):
    """Returns the timeline events that the browser traced while the page played."""
    browser.send(
        "Tracing.start",
        {"traceConfig": {"includedCategories": ["devtools.timeline"]},
         "transferMode": "ReportEvents"},
        browser=True,
    )
    browser.run("retarget.player.seek(0); retarget.player.play()")
    time.sleep(seconds)
    browser.run("retarget.player.pause()")
    browser.send("Tracing.end", browser=True)
    deadline = time.monotonic() + 120
    while not any(event.get("method") == "Tracing.tracingComplete" for event in browser.events):
        browser.events.append(browser.receive(deadline))
    return [
        event
        for message in browser.events
        if message.get("method") == "Tracing.dataCollected"
        for event in message["params"]["value"]
    ]


def figures(name, values):
    p95 = statistics.quantiles(values, n=20)[-1]
    return f"{name}: median {statistics.median(values):.2f} ms, 95th percentile {p95:.2f} ms"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tool")
    parser.add_argument("clip", type=pathlib.Path)
    parser.add_argument("--robot", default="unitree_g1")
    parser.add_argument("--size", default="1280x720")
    arguments = parser.parse_args()
    program = chromium()
    if program is None:
        sys.exit("there is no Chromium (Debian: chromium)")
    width, height = map(int, arguments.size.split("x"))
    with tempfile.TemporaryDirectory() as folder:
        page = make_page(arguments.tool, arguments.clip, arguments.robot, pathlib.Path(folder))
        with Browser(program, width, height) as browser:
            browser.open(page, "#t=0")
            browser.wait_for("window.retarget")
            for _ in range(5):
                browser.press("+")
            duration = browser.run("retarget.player.duration")
            events = trace(browser, duration / SPEED)
    found = [event for event in events if event["name"] == CALLBACK and event["ph"] == "X"]
    if len(found) < 20:
        sys.exit(f"only {len(found)} pictures were drawn")
    print(f"{len(found)} pictures of {duration:.0f} s at {SPEED:g} times the speed, {arguments.size}")
    print(figures("clock", [event["dur"] / 1000 for event in found]))
    own = [event["tdur"] / 1000 for event in found if "tdur" in event]
    if own:
        print(figures("thread", own))


if __name__ == "__main__":
    main()
