"""`retarget view FOLDER` in a headless browser."""

import json
import time
import unittest

from browser import Browser, chromium
from galleries import GalleryTest, ODD
from tool import absent, short_clip


class GalleryInABrowser(GalleryTest):
    def setUp(self):
        super().setUp()
        self.program = chromium()
        if self.program is None:
            absent("there is no Chromium (Debian: chromium)")

    def names(self, browser):
        return browser.run(
            "[...document.querySelectorAll('.clip h2')].map((node) => node.textContent)")

    def choose(self, browser, identity, value):
        browser.run(f"document.getElementById('{identity}').value = {json.dumps(value)};"
                    "document.getElementById('tools').dispatchEvent(new Event('input'))")

    def follow(self, browser, condition):
        """Follows a link and waits for the page."""
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline:
            try:
                return browser.wait_for(condition, wait=deadline - time.monotonic())
            except RuntimeError:
                # Requested while the browser was between two pages.
                time.sleep(0.05)
        return self.fail(condition)

    def test_a_thousand_clips(self):
        self.batch(clips=("walk",))
        entry = self.entries()[0]
        entries = []
        for i in range(1000):
            quality = json.loads(json.dumps(entry["quality"]))
            quality["figures"]["peak_speed"] = 1.0 + i * 7919 % 1000
            quality["gates_missed"] = ["jumps"] if i % 4 == 0 else []
            entries.append({**entry, "relative": f"take {i % 10}/clip_{i}.bvh", "frames": 30 + i,
                            "quality": quality,
                            "outputs": [{**entry["outputs"][0], "file": f"gone/{i}.csv"}]})
        self.write_entries(entries)
        result = self.gallery()
        self.assert_done(result)
        self.assertIn("1000 motions of the manifest are missing: gone/", result.stderr)
        page = self.folder / "gallery/index.html"
        self.assertLess(page.stat().st_size, 2_000_000)
        with Browser(self.program) as browser:
            browser.open(page)
            self.assertEqual(len(self.names(browser)), 1000)
            # The page stays fast on a busy machine: it has few elements, and cards out of sight are
            # neither laid out nor drawn.
            elements = browser.run("document.querySelectorAll('*').length")
            self.assertLess(elements, 13_000)
            skipped = browser.run(
                "[...document.querySelectorAll('.clip')].filter((card) =>"
                "!card.querySelector('h2').checkVisibility({contentVisibilityAuto: true})).length")
            self.assertGreater(skipped, 900)
            self.choose(browser, "search", "CLIP_99 take")
            self.assertEqual(sorted(self.names(browser)), sorted(
                [f"take {i % 10}/clip_{i}.bvh" for i in (99, *range(990, 1000))]))
            self.choose(browser, "search", "")
            self.choose(browser, "filter", "gate jumps")
            self.assertEqual(len(self.names(browser)), 250)
            self.assertIn("250 of 1000 clips",
                          browser.run("document.getElementById('count').textContent"))
            self.choose(browser, "filter", "")
            self.choose(browser, "sort", "seconds")
            self.assertEqual(self.names(browser)[0], "take 9/clip_999.bvh")
            metric = [each["key"] for each in self.index()["metrics"]].index("peak_speed")
            self.choose(browser, "sort", f"figure {metric}")
            worst = max(range(1000), key=lambda i: i * 7919 % 1000)
            self.assertEqual(self.names(browser)[0], f"take {worst % 10}/clip_{worst}.bvh")
            browser.run("document.getElementById('turn').click()")
            self.assertEqual(self.names(browser)[0], "take 0/clip_0.bvh")
            self.choose(browser, "search", "nothing like it")
            self.assertFalse(browser.run("document.getElementById('nothing').hidden"))
            self.assertEqual(browser.complaints(), [])
            self.assertEqual(len(browser.requests()), 1)

    def test_passed_clips_come_first_and_failures_are_folded(self):
        self.write("clips/broken.bvh", b"HIERARCHY\n")
        self.batch()
        entries = self.entries()
        done = [entry for entry in entries if entry["status"] == "done"]
        self.assertEqual(len(done), 2)
        done[0]["quality"]["gates_missed"] = ["jumps"]
        done[1]["quality"]["gates_missed"] = []
        self.write_entries(entries)
        self.assert_done(self.gallery())
        passed, missed = done[1]["relative"], done[0]["relative"]
        with Browser(self.program) as browser:
            browser.open(self.folder / "gallery/index.html")
            self.assertEqual(self.names(browser), [passed, missed, "broken.bvh"])
            failed = "document.getElementById('failed')"
            self.assertEqual(browser.run(f"[{failed}.hidden, {failed}.open]"), [False, False])
            self.assertEqual(browser.run("document.getElementById('failed-count').textContent"),
                             "1 clip failed")
            # The keys between pages follow this order.
            pages = browser.run("[...document.querySelectorAll('a.clip')].map((node) => node.href)")
            browser.run("document.querySelector('a.clip').click()")
            self.follow(browser, f"window.retarget && location.href === {json.dumps(pages[0])}")
            browser.press("]")
            self.follow(browser, f"window.retarget && location.href === {json.dumps(pages[1])}")
            browser.open(self.folder / "gallery/index.html")
            self.choose(browser, "sort", "worst")
            self.assertEqual(self.names(browser), ["broken.bvh", missed, passed])
            self.assertTrue(browser.run(f"{failed}.hidden"))
            # If only failures are shown, they are not folded.
            self.choose(browser, "sort", "passed")
            self.choose(browser, "filter", "failed")
            self.assertEqual(self.names(browser), ["broken.bvh"])
            self.assertTrue(browser.run(f"{failed}.hidden"))
            # A gate has a plain label, its name is the tooltip.
            options = browser.run("[...document.querySelectorAll('#filter option')]"
                                  ".map((each) => [each.textContent, each.title])")
            self.assertIn(["Joint jumps", "jumps"], options)
            self.assertEqual(browser.complaints(), [])

    def test_pictures_links_keys_and_odd_names(self):
        self.write("clips/" + ODD, short_clip("wave", 30))
        self.batch()
        self.assert_done(self.gallery())
        with Browser(self.program) as browser:
            browser.open(self.folder / "gallery/index.html")
            browser.wait_for("document.images.length === 3 && "
                             "[...document.images].every((image) => image.naturalWidth > 100)")
            self.assertIn(ODD, self.names(browser))
            self.assertEqual(browser.complaints(), [])
            policy = browser.run(
                "document.querySelector('meta[http-equiv=Content-Security-Policy]').content")
            self.assertIn("img-src 'self';", policy)
            pages = browser.run("[...document.querySelectorAll('a.clip')].map((node) => node.href)")
            self.assertEqual(len(pages), 3)
            browser.run("document.querySelector('a.clip').click()")
            # Into the first, on to the others, back, and to the index.
            for key, wanted in (("", 0), ("]", 1), ("]", 2), ("]", 2), ("[", 1)):
                if key:
                    browser.press(key)
                there = f"location.href === {json.dumps(pages[wanted])}"
                self.follow(browser, f"window.retarget && {there}")
            self.assertEqual(browser.complaints(), [])
            browser.run("document.querySelector('.clip-link').click()")
            self.follow(browser, "document.getElementById('clips')")


if __name__ == "__main__":
    unittest.main()
