"""Pages of `retarget view` and `--html` in a headless browser: access, security, meshes, pictures."""

import base64
import os
import pathlib
import shutil
import struct
import unittest

import numpy as np

import pictures
from pages_in_browser import PagesInABrowser
from tool import SOURCE

ROBOT = SOURCE / "robots/unitree_g1/model.xml"
PICTURES = pathlib.Path(__file__).resolve().parent / "view_browser_pictures"


def box_stl(low, high):
    """A box as binary STL."""
    corners = [[(low, high)[i >> axis & 1][axis] for axis in range(3)] for i in range(8)]
    faces = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    triangles = [(a, b, c) for a, b, c, d in faces] + [(a, c, d) for a, b, c, d in faces]
    return (
        bytes(80)
        + struct.pack("<I", len(triangles))
        + b"".join(
            struct.pack("<12fH", 0, 0, 0, *(value for i in each for value in corners[i]), 0)
            for each in triangles
        )
    )


class PageInABrowser(PagesInABrowser):
    """Accessibility, security, meshes and pictures of pages."""

    def test_choices_contain_only_valid_values(self):
        self.open("two.html")
        self.assertEqual(
            self.run_script(
                "[...document.querySelectorAll('[role=radiogroup] > :not([role=radio], .name)')]"
                ".map((each) => each.outerHTML)"
            ),
            [],
        )
        # Exactly one mark is announced as the current one.
        self.browser.press("n")
        self.browser.press("n")
        self.assertEqual(
            self.run_script(
                "[...document.querySelectorAll('.mark')]"
                ".map((each) => each.getAttribute('aria-current'))"
                ".filter((value) => value !== null)"
            ),
            ["true"],
        )

    def test_narrow_dark_and_calm(self):
        self.open(
            "one.html",
            "",
            size=(390, 844),
            features={"prefers-color-scheme": "dark", "prefers-reduced-motion": "reduce"},
        )
        self.assertFalse(self.run_script("retarget.player.playing"))
        self.assertLessEqual(self.run_script("document.documentElement.scrollWidth"), 390)
        self.assertEqual(
            self.run_script("getComputedStyle(document.body).backgroundColor"), "rgb(20, 23, 28)"
        )
        # All controls are within the window's width.
        outside = self.run_script(
            "[...document.querySelectorAll('button, select, input')]"
            ".filter((each) => each.offsetParent && !each.closest('.lane'))"
            ".filter((each) => each.getBoundingClientRect().right > innerWidth + 8)"
            ".map((each) => each.outerHTML)"
        )
        self.assertEqual(outside, [])
        self.assert_quiet("one.html")

    def test_low_windows(self):
        for name in ("one.html", "two.html"):
            for size in ((844, 390), (1024, 420), (1280, 400), (667, 375)):
                with self.subTest(page=name, size=size):
                    self.open(name, size=size)
                    # Nothing covers the controls, once they are scrolled into the window.
                    covered = self.run_script(
                        "[...document.querySelectorAll('#buttons button, #view-tools button')]"
                        ".filter((each) => each.offsetParent).filter((each) => {"
                        " each.scrollIntoView({ block: 'center', behavior: 'instant' });"
                        " const box = each.getBoundingClientRect();"
                        " return !each.contains(document.elementFromPoint("
                        "box.x + box.width / 2, box.y + box.height / 2)); })"
                        ".map((each) => each.outerHTML)"
                    )
                    self.assertEqual(covered, [])
                    overlap = self.run_script(
                        "document.getElementById('stage').getBoundingClientRect().bottom - "
                        "document.getElementById('transport').getBoundingClientRect().top"
                    )
                    self.assertLessEqual(overlap, 1)

    def test_everything_has_a_name(self):
        self.open("two.html", size=(1280, 720))
        self.assertLessEqual(
            self.run_script(
                "(({ scrollWidth, scrollHeight }) => `${scrollWidth},${scrollHeight}`)"
                "(document.documentElement)"
            ),
            "1280,720",
        )
        self.run_script("document.getElementById('tab-joints').click()")
        nameless = self.run_script(
            "[...document.querySelectorAll("
            "'button, select, input, canvas, [role=tabpanel], section, aside')]"
            ".filter((each) => each.offsetParent && !each.closest('[aria-hidden=true]'))"
            ".filter((each) => !each.getAttribute('aria-label') && !each.textContent.trim()"
            " && !each.getAttribute('aria-labelledby')).map((each) => each.outerHTML)"
        )
        self.assertEqual(nameless, [])
        # Tab moves the focus, and the focused element shows it.
        self.browser.press("Tab")
        self.assertEqual(self.run_script("document.activeElement.id"), "help-button")
        seen = set()
        for _ in range(40):
            name, shown = self.run_script(
                "(({ activeElement }) => [activeElement.tagName + ' ' + (activeElement.id || "
                "activeElement.getAttribute('aria-label') || activeElement.textContent), "
                "getComputedStyle(activeElement).outlineStyle !== 'none' "
                "&& parseFloat(getComputedStyle(activeElement).outlineWidth) > 0])(document)"
            )
            if name in seen or name.startswith("BODY"):
                break
            seen.add(name)
            self.assertTrue(shown, f"{name} has the focus and does not show it")
            self.browser.press("Tab")
        self.assertGreater(len(seen), 10)
        self.assertIn(
            "s",
            self.run_script(
                "document.querySelector('.scrub input').getAttribute('aria-valuetext')"
            ),
        )

    def test_the_policy_allows_only_the_page_itself(self):
        self.open("one.html")
        # The browser reports violations of the policy; a request that fails without a network has
        # no such report.
        self.run_script(
            "window.violations = [];"
            "document.addEventListener('securitypolicyviolation',"
            " (event) => violations.push(event.effectiveDirective))"
        )
        for directive, script in (
            (
                "script-src-elem",
                "(() => { const script = document.createElement('script');"
                "script.textContent = 'window.injected = 1'; document.body.append(script); })()",
            ),
            ("connect-src", "fetch('https://example.org/').catch(() => 0)"),
            ("img-src", "void (new Image().src = 'https://example.org/a.png')"),
            ("img-src", "void (new Image().src = 'data:image/gif;base64,R0lGODlhAQABAAAAACw=')"),
            (
                "style-src-elem",
                "(() => { const style = document.createElement('style');"
                "style.textContent = 'body { color: red }'; document.body.append(style); })()",
            ),
            (
                "frame-src",
                "(() => { const frame = document.createElement('iframe');"
                "frame.src = 'https://example.org/'; document.body.append(frame); })()",
            ),
            # Later, since the policy allows requests that a test's own script makes directly.
            (
                "script-src",
                "void setTimeout(() => { try { (0, eval)('window.injected = 1'); } catch {} }, 1)",
            ),
        ):
            with self.subTest(directive):
                self.run_script("violations.length = 0")
                self.run_script(f"Promise.resolve({script}).then(() => 0)")
                self.browser.wait_for("violations.length > 0", wait=10)
                self.assertEqual(self.run_script("violations[0]"), directive)
        self.assertFalse(self.run_script("'injected' in window"))

    def test_names_are_only_text(self):
        bad = "<script>window.hacked=1</script>"
        worse = "</script><img src=x onerror=window.hacked=1>"
        odd = "\u202e\U0001f600\u2028'\"&amp;${hacked}"
        model = ROBOT.read_text()
        joint = worse.replace("<", "&lt;").replace(">", "&gt;")
        model = model.replace("left_knee_joint", joint).replace(
            "torso_link", bad.replace("<", "&lt;")
        )
        (self.pages / "odd.xml").write_text(model, encoding="utf-8")
        name = (bad + odd).replace("/", "\u2215") + ".csv"
        shutil.copy(self.pages / "fit.csv", self.pages / name)
        self.assert_done(
            self.run_in_pages(
                "view",
                name,
                "fit.csv",
                "--label",
                worse + odd,
                "--label",
                bad + "@SCRIPT@",
                "--robot-xml",
                "odd.xml",
                "-o",
                "odd.html",
            )
        )
        self.open("odd.html")
        self.run_script("for (const tab of document.querySelectorAll('[role=tab]')) tab.click()")
        self.run_script(
            "const select = document.querySelector('#panel-body select'); select.selectedIndex = 5;"
            "select.dispatchEvent(new Event('change'))"
        )
        self.assertFalse(self.run_script("'hacked' in window"))
        self.assertEqual(
            self.run_script("document.querySelectorAll('img, script').length"),
            1,
        )
        self.assertIn(bad, self.run_script("document.getElementById('title').textContent"))
        self.assertEqual(self.run_script("retarget.motions[0].label"), worse + odd)
        self.assertIn(worse, self.run_script("Object.keys(retarget.joints(0, 0))"))
        self.assert_quiet("odd.html")

    def test_meshes_replace_shapes(self):
        folder = self.pages / "meshes"
        folder.mkdir()
        (folder / "TORSO_LINK_rev_2.STL").write_bytes(box_stl((-0.1, -0.2, 0.0), (0.1, 0.2, 0.4)))
        # in millimetres, as text
        corners = "\n".join(
            f"v {1000 * x} {1000 * y} {1000 * z}"
            for x, y, z in ((0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.3))
        )
        (folder / "left_knee.obj").write_text(corners + "\nf 1 2 3\nf 1//1 2//1 4//1\nf -4 -2 -1\n")
        self.assert_done(
            self.run_in_pages(
                "view",
                "fit.csv",
                "--robot",
                "unitree_g1",
                "--meshes",
                "meshes",
                "-o",
                "meshes.html",
            )
        )
        self.open("meshes.html")
        names = self.run_script("retarget.bodies(0).map((each) => each.name)")
        found = {names[each["body"]]: each for each in self.run_script("retarget.meshes(0)")}
        self.assertEqual(found.keys(), {"torso_link", "left_knee_link"})
        for name, low, high in (
            ("torso_link", (-0.1, -0.2, 0.0), (0.1, 0.2, 0.4)),
            ("left_knee_link", (0, 0, 0), (0.1, 0.1, 0.3)),
        ):
            self.assertLess(np.abs(np.subtract(found[name]["min"], low)).max(), 2.1e-4)
            self.assertLess(np.abs(np.subtract(found[name]["max"], high)).max(), 2.1e-4)
        self.run_script(
            "[...document.querySelectorAll('button')]"
            ".find((each) => each.textContent === 'Meshes').click()"
        )
        self.assertEqual(self.run_script("retarget.meshes(0)"), [])
        self.assert_quiet("meshes.html")
        # A body whose mesh cannot be read keeps its primitives.
        (folder / "pelvis.stl").write_text("solid\nvertex 1 2 x")
        result = self.run_in_pages(
            "view", "fit.csv", "--robot", "unitree_g1", "--meshes", "meshes", "-o", "partial.html"
        )
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("pelvis.stl: expected three numbers", result.stderr)
        self.open("partial.html")
        self.assertEqual(
            {names[each["body"]] for each in self.run_script("retarget.meshes(0)")},
            {"torso_link", "left_knee_link"},
        )
        self.assertEqual(
            self.run_in_pages(
                "view", "fit.csv", "--robot", "unitree_g1", "--meshes", "none", "-o", "bad.html"
            ).returncode,
            2,
        )

    def test_pictures(self):
        """Compares coarse pictures with the committed ones.

        RETARGET_WRITE_PICTURES=1 writes them anew."""
        scenes = {
            "beside": ("one.html", "#t=3", {}, "0"),
            "three": ("two.html", "#t=6.5", {}, "0"),
            "dark_over": (
                "one.html",
                "#t=3",
                {"prefers-color-scheme": "dark"},
                "[...document.querySelectorAll('[aria-label=Human] button')][1].click()",
            ),
        }
        found = {}
        for name, (page, fragment, features, script) in scenes.items():
            self.open(page, fragment, size=(640, 400), features=features)
            self.run_script(script)
            # Only the scene, at a size independent of fonts, which differ between machines.
            self.run_script("""Object.assign(document.getElementById('stage').style,
                {position: 'fixed', left: 0, top: 0, width: '640px', height: '400px',
                 minHeight: 0});""")
            self.browser.wait_for(
                "(({ width, height }) => width === 640 && height === 400)"
                "(document.getElementById('canvas'))"
            )
            # The camera of a window of this size.
            self.browser.press("r")
            picture = self.run_script("retarget.picture()")
            pixels = np.frombuffer(base64.b64decode(picture["rgba"]), np.uint8)
            found[name] = pictures.coarse(
                pixels.reshape(picture["height"], picture["width"], 4)[:, :, :3]
            )
        if os.environ.get("RETARGET_WRITE_PICTURES"):
            PICTURES.mkdir(exist_ok=True)
            for name, picture in found.items():
                (PICTURES / f"{name}.png").write_bytes(pictures.write_png(picture))
        for name, picture in found.items():
            with self.subTest(name):
                expected = pictures.read_png((PICTURES / f"{name}.png").read_bytes())
                self.assertEqual(picture.shape, expected.shape)
                mean, share = pictures.differences(picture, expected)
                self.assertLess(mean, 4.0)
                self.assertLess(share, 0.02)
        # The comparison can fail.
        mean, share = pictures.differences(found["beside"], found["three"])
        self.assertTrue(mean > 4.0 and share > 0.02)


if __name__ == "__main__":
    unittest.main()
