"""A headless browser with pages of `retarget view`, for several tests."""

import pathlib
import shutil
import tempfile
import unittest

import browser
from tool import TOOL, ToolTest, absent, is_sanitized, sample


class PagesInABrowser(ToolTest):
    """Tests that share one browser and its pages."""

    @classmethod
    def setUpClass(cls):
        program = browser.chromium()
        if not TOOL:
            raise unittest.SkipTest("the tool is not built")
        if is_sanitized():
            raise unittest.SkipTest("pages are the same, and take a minute longer")
        if not program:
            absent("there is no Chromium (Debian: chromium)")
        cls.pages = pathlib.Path(tempfile.mkdtemp(prefix="retarget pages "))
        cls.addClassCleanup(shutil.rmtree, cls.pages, ignore_errors=True)
        maker = cls("make_pages")
        maker.folder = cls.pages
        maker.make_pages()
        cls.browser = browser.Browser(program, 900, 560)
        cls.addClassCleanup(cls.browser.close)

    def make_pages(self):
        shutil.copy(sample("walk"), self.folder / "walk.bvh")
        for output, *options in (
            ("fit.csv", "--html", "run.html"),
            ("gmr.csv", "--method", "gmr"),
            ("fit.npz", "--format", "npz-mjlab", "--npz-fps", 30),
        ):
            self.assert_done(self.run_tool("walk.bvh", "unitree_g1", "-o", output, *options))
        for output, *motions in (("one.html", "fit.csv"), ("two.html", "fit.csv", "gmr.csv")):
            self.assert_done(
                self.run_tool(
                    "view", *motions, "--robot", "unitree_g1", "--bvh", "walk.bvh", "-o", output
                )
            )

    def open(self, page, fragment="#t=0", **options):
        self.browser.open(self.pages / page, fragment, **options)
        self.browser.wait_for("window.retarget")

    def run_script(self, script):
        return self.browser.run(script)

    def assert_quiet(self, page):
        """Asserts an empty console and no requests except for the page."""
        self.assertEqual(self.browser.complaints(), [])
        self.assertEqual(self.browser.requests(), [(self.pages / page).resolve().as_uri()])

    def run_in_pages(self, *arguments):
        self.folder = self.pages
        return self.run_tool(*arguments)

    def time(self):
        return self.run_script("retarget.player.time")
