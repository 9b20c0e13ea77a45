"""`retarget inspect --html`: a page about a source, read by hand and in a browser."""

import base64
import json
import re
import unittest
import zlib

import numpy as np

from browser import Browser, chromium
from tool import ToolTest, absent, short_clip


def page_header(text):
    """The JSON of a page."""
    header = re.search(r'id="page-header">(.*?)</script>', text, re.S)[1]
    return json.loads(zlib.decompress(base64.b64decode(header)))


class InspectPage(ToolTest):
    def page(self, name="walk.bvh", clip=None, *options):
        self.write(name, clip or short_clip("walk", 40))
        self.assert_done(self.run_tool("inspect", name, "--html", "page.html", *options))
        return (self.folder / "page.html").read_text()

    def test_page_shows_the_findings(self):
        skeleton = page_header(self.page())["skeleton"]
        self.assertEqual(skeleton["frames"], 40)
        self.assertTrue(skeleton["understood"])
        self.assertIn("LAFAN1", skeleton["facts"])
        self.assertEqual(skeleton["up"], "+y")
        sides = {point["name"]: point["side"] for point in skeleton["points"]}
        self.assertEqual([sides[n] for n in ("LeftArm", "RightLeg", "Spine", "LeftToe_end")],
                         ["left", "right", "middle", "left"])
        bones = {point["name"]: point.get("bone") for point in skeleton["points"]}
        self.assertEqual(bones["LeftForeArm"], "LeftForeArm")
        self.assertIsNone(bones["LeftToe_end"])

    def test_other_skeletons_are_shown_and_reported(self):
        text = self.page("chain.bvh", b"""HIERARCHY
ROOT a<script>alert(1)</script>
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT b
  { OFFSET 0 10 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    { OFFSET 0 10 0 }
  }
}
MOTION
Frames: 2
Frame Time: 0.1
0 0 0 0 0 0 0 0 0
0 0 0 0 0 0 90 0 0
""")
        skeleton = page_header(text)["skeleton"]
        self.assertFalse(skeleton["understood"])
        self.assertEqual(len(skeleton["doubts"]), 1)
        self.assertNotIn("<script>alert", text)
        self.assertNotIn("height", skeleton)

    def test_faults_are_explained(self):
        self.write("walk.bvh", short_clip("walk", 4))
        self.assert_fails(self.run_tool("inspect", "walk.bvh", "--html", "-"), 2, "--html")
        self.assert_fails(self.run_tool("inspect", "walk.bvh", "--html", "no/x.html"), 2, "no")
        self.assert_fails(self.run_tool("inspect", "walk.bvh", "--html", "walk.bvh"), 2, "walk.bvh")
        self.assertEqual(self.files(), ["walk.bvh"])

    def test_the_browser_shows_joints_where_they_are(self):
        program = chromium()
        if program is None:
            absent("there is no Chromium (Debian: chromium)")
        self.page()
        self.assert_done(self.run_tool("inspect", "walk.bvh", "--positions", "places.csv"))
        names = (self.folder / "places.csv").read_text().splitlines()[0].split(",")
        places = np.loadtxt(self.folder / "places.csv", delimiter=",", skiprows=1)
        with Browser(program) as browser:
            browser.open(self.folder / "page.html")
            browser.wait_for("window.retarget")
            for frame in (0, 7, 39):
                shown = browser.run(f"window.retarget.show({frame}); window.retarget.joints()")
                self.assertEqual(len(shown), 27)
                for joint in shown:
                    columns = [names.index(f"{joint['name']}.{axis}") for axis in "xyz"]
                    # Centimetres, Y up in the file; metres, Z up there.
                    x, y, z = 0.01 * places[frame, columns]
                    np.testing.assert_allclose(joint["position"], [x, -z, y], atol=2e-4)
            self.assertEqual(browser.complaints(), [])
            self.assertEqual(len(browser.requests()), 1)
            # The rest pose has zero rotations: only the offsets.
            thighs = []
            for points in (browser.run("window.retarget.rest()"), shown):
                places = {point["name"]: np.array(point["position"]) for point in points}
                thighs.append(np.linalg.norm(places["LeftLeg"] - places["LeftUpLeg"]))
            self.assertAlmostEqual(*thighs, delta=1e-3)

    def test_a_link_leads_to_a_moment_and_calm_is_kept(self):
        program = chromium()
        if program is None:
            self.skipTest("there is no Chromium (Debian: chromium)")
        self.page()
        with Browser(program) as browser:
            browser.open(self.folder / "page.html", fragment="#t=0.2")
            browser.wait_for("window.retarget")
            self.assertAlmostEqual(browser.run("window.retarget.player.time"), 0.2)
            self.assertFalse(browser.run("window.retarget.player.playing"))
            browser.run("window.location.hash = 't=0.1'")
            browser.wait_for("Math.abs(window.retarget.player.time - 0.1) < 1e-9")
            orbit = ("[...document.querySelectorAll('button')]"
                     ".find((button) => button.textContent === 'Orbit').click()")
            # An orbiting camera draws without end, also while nothing plays.
            browser.run(orbit)
            browser.run("new Promise((done) => setTimeout(done, 500))")
            self.assertTrue(browser.run("window.retarget.pictureDue()"))
            browser.open(self.folder / "page.html",
                         features={"prefers-reduced-motion": "reduce"})
            browser.wait_for("window.retarget")
            self.assertFalse(browser.run("window.retarget.player.playing"))
            browser.run(orbit)
            browser.wait_for("!window.retarget.pictureDue()")


if __name__ == "__main__":
    unittest.main()
