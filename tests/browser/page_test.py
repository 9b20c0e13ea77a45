"""The browser page end to end in headless Chromium: from a file on the disk to the CSV."""

import base64
import json
import pathlib
import tempfile
import unittest

from browser_build import PAGE, need_page, run_native
from browser import Browser, chromium  # found by browser_build
from tool import absent, difference, read_rows, sample

SOLVED = "document.documentElement.dataset.state !== 'solving'"


class BrowserPage(unittest.TestCase):
    """One page, opened from disk."""

    @classmethod
    def setUpClass(cls):
        need_page()
        program = chromium()
        if program is None:
            absent("there is no Chromium")
        cls.browser = Browser(program)
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.browser.open(PAGE)
        self.browser.wait_for("document.documentElement.dataset.state === 'ready'")

    def give(self, name, path):
        """Puts a file into the page's file input, as a user's choice does."""
        content = base64.b64encode(pathlib.Path(path).read_bytes()).decode()
        self.browser.run(
            f"""(() => {{
              const bytes = Uint8Array.from(atob({json.dumps(content)}), (c) => c.charCodeAt(0));
              const transfer = new DataTransfer();
              transfer.items.add(new File([bytes], {json.dumps(name)}));
              const input = document.getElementById('file');
              input.files = transfer.files;
              input.dispatchEvent(new Event('change'));
            }})()"""
        )

    def wait_until_solved(self):
        self.browser.run("new Promise((done) => setTimeout(done, 100))")
        self.browser.wait_for(SOLVED, wait=300)
        status = self.browser.run("document.getElementById('status').textContent")
        self.assertEqual(self.browser.run("document.documentElement.dataset.state"), "solved", status)

    def csv(self):
        """The text of the CSV that the page offers."""
        return self.browser.run("decoder.decode(results.get('motion.csv'))")

    def native(self, name, *arguments):
        output = self.folder / "native.csv"
        done = run_native(sample(name), "unitree_g1", "-o", output, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return output.read_text()

    def test_from_a_file_to_the_csv(self):
        self.give("walk.bvh", sample("walk"))
        self.wait_until_solved()
        self.assertIsNone(difference(read_rows(self.csv()), read_rows(self.native("walk")), 1e-6))
        self.assertEqual(
            self.browser.run("document.getElementById('csv').download"), "walk_unitree_g1.csv")
        self.assertIn("gates", self.browser.run("document.getElementById('verdict').textContent"))
        self.assertGreater(
            self.browser.run("document.querySelectorAll('#timeline .contact').length"), 3)
        # Nothing is loaded, and no policy is violated.
        outside = [url for url in self.browser.requests() if not url.startswith(("file:", "blob:", "about:", "data:"))]
        self.assertEqual(outside, [])
        self.assertEqual(self.browser.complaints(), [])

    def test_contact_edits_are_those_of_the_tool(self):
        self.give("walk.bvh", sample("walk"))
        self.wait_until_solved()
        before = self.csv()
        edit = {"part": "left_foot", "action": "remove", "start": 0.2, "end": 0.6}
        self.browser.run(f"editor.add({json.dumps(edit)})")
        self.browser.run("document.getElementById('solve-edits').click()")
        self.wait_until_solved()
        edits = self.folder / "edits.json"
        edits.write_text(self.browser.run("editor.text()"))
        expected = self.native("walk", "--contact-edits", edits)
        self.assertNotEqual(self.csv(), before)
        self.assertIsNone(difference(read_rows(self.csv()), read_rows(expected), 1e-6))

    def drag(self, begin, end):
        """Drags on the row of the left heel, between two times."""
        points = self.browser.run(
            f"""(() => {{
              const row = document.querySelector('.row[data-part=left_heel]');
              row.scrollIntoView({{ block: 'center' }});
              const box = row.getBoundingClientRect();
              const at = (seconds) => box.left + box.width * seconds / editor.seconds;
              return [at({begin}), at({end}), box.top + box.height / 2];
            }})()"""
        )
        for kind, x in (("mousePressed", points[0]), ("mouseMoved", points[1]), ("mouseReleased", points[1])):
            self.browser.send(
                "Input.dispatchMouseEvent",
                {"type": kind, "x": x, "y": points[2], "button": "left", "buttons": 1, "clickCount": 1})

    def test_timeline_makes_edits(self):
        self.give("walk.bvh", sample("walk"))
        self.wait_until_solved()
        (first_begin, first_end), (begin, end) = self.browser.run("editor.contacts.left_heel.slice(0, 2)")
        self.drag(first_end + 0.1, begin - 0.1)
        self.drag((begin + end) / 2, (begin + end) / 2 + 0.2)
        self.browser.run("document.getElementById('whole-foot').click()")
        self.drag((first_begin + first_end) / 2, (first_begin + first_end) / 2)
        self.browser.press("Delete")
        edits = self.browser.run("editor.edits")
        self.assertEqual([edit["action"] for edit in edits], ["add", "shift", "remove"])
        self.assertEqual([edit["part"] for edit in edits], ["left_foot", "left_foot", "left_heel"])
        self.assertAlmostEqual(edits[0]["start"], first_end + 0.1, delta=0.03)
        self.assertAlmostEqual(edits[0]["end"], begin - 0.1, delta=0.03)
        self.assertAlmostEqual(edits[1]["by"], 0.2, delta=0.03)
        self.assertAlmostEqual(edits[2]["end"], first_end, delta=0.03)
        # Each edit can be undone.
        self.browser.run("document.querySelector('#edits button').click()")
        self.assertEqual(self.browser.run("editor.edits.length"), 2)

    def test_options_and_method(self):
        self.browser.run(
            """(() => {
              const set = (id, value) => {
                const input = document.getElementById(id);
                input.value = value;
                input.dispatchEvent(new Event('change'));
              };
              set('method', 'gmr');
              set('option-fps', '50');
            })()"""
        )
        self.give("wave.bvh", sample("wave"))
        self.wait_until_solved()
        expected = self.native("wave", "--method", "gmr", "--fps", "50")
        self.assertIsNone(difference(read_rows(self.csv()), read_rows(expected), 1e-6))

    def test_a_bad_file_is_explained(self):
        bad = self.folder / "bad.bvh"
        bad.write_text("HIERARCHY\n")
        self.give("bad.bvh", bad)
        self.browser.wait_for("document.documentElement.dataset.state === 'failed'")
        self.assertIn("bad.bvh", self.browser.run("document.getElementById('status').textContent"))
        # The page works on.
        self.browser.run("document.getElementById('method').value = 'gmr'")
        self.give("wave.bvh", sample("wave"))
        self.wait_until_solved()


if __name__ == "__main__":
    unittest.main()
