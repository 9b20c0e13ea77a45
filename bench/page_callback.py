#!/usr/bin/env python3
"""How long a page's script takes for a picture: two robots and their source through a minute of motion.

    bench/page_callback.py build/release/tools/retarget/retarget dance.bvh [--robot NAME] [--size 1280x720]

makes two motions of the first minute (published method and fit), plays their page in Chromium without a
window at four times the speed, traces it, and prints median and 95th percentile of what
requestAnimationFrame's callback takes, in milliseconds: by the clock, and of the thread's own time, which other
programs do not lengthen. WebGL is done by the processor there (SwiftShader), in another process; the
callback is the script alone. Needs Chromium; no window, no graphics card."""

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
    """A page of two motions of a clip's first minute beside it."""

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
    """What the browser traced of its timeline while the page played, one event each."""
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
