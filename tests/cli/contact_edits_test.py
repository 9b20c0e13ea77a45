"""`--contact-edits`: contacts that are added, removed and shifted by hand, and what the robot's feet then do."""

import json
import unittest

from tool import ToolTest, sample


class ContactEdits(ToolTest):
    """Runs of walk.bvh with edits, and refused ones."""

    def edits(self, *edits):
        return self.write("edits.json", json.dumps({"contacts": edits}))

    def solve(self, name, *arguments):
        """Solves the walk; returns the motion's file and the planted feet: rows of left, right."""
        motion, contacts = self.folder / f"{name}.csv", self.folder / f"{name}_contacts.csv"
        done = self.retarget("--contacts", contacts, *arguments, bvh=sample("walk"), output=motion)
        self.assert_done(done)
        lines = contacts.read_text().splitlines()
        names = lines[0].split(",")
        rows = [dict(zip(names, line.split(","))) for line in lines[1:]]
        return motion, rows, done

    def planted(self, rows, foot, begin, end):
        """The share of the frames in [begin, end) in which any column of a foot is in contact."""
        columns = [key for key in rows[0] if foot in key]
        self.assertTrue(columns, rows[0])
        part = rows[begin:end]
        return sum(any(row[key] not in ("", "0") for key in columns) for row in part) / len(part)

    def stance(self, rows, foot):
        """The first stance of at least ten frames after the first frame: [begin, end)."""
        begin = None
        for frame, row in enumerate(rows):
            down = self.planted([row], foot, 0, 1) == 1
            if down and begin is None:
                begin = frame
            if not down and begin is not None:
                if begin > 0 and frame - begin >= 10:
                    return begin, frame
                begin = None
        return self.fail("no stance")

    def test_a_removed_stance_is_not_planted(self):
        plain, rows, _ = self.solve("plain")
        begin, end = self.stance(rows, "left")
        edit = {"part": "left_foot", "action": "remove", "start": begin / 30, "end": end / 30}
        edited, changed, done = self.solve("edited", "--contact-edits", self.edits(edit))
        self.assertEqual(self.planted(rows, "left", begin, end), 1)
        self.assertEqual(self.planted(changed, "left", begin + 1, end - 1), 0)
        self.assertNotEqual(plain.read_bytes(), edited.read_bytes())
        self.assertIn("1 edit of", done.stdout + done.stderr)

    def test_an_added_stance_is_planted(self):
        _, rows, _ = self.solve("plain")
        _, end = self.stance(rows, "right")
        edit = {"part": "right_foot", "action": "add", "start": end / 30, "end": (end + 6) / 30}
        _, changed, _ = self.solve("edited", "--contact-edits", self.edits(edit))
        self.assertLess(self.planted(rows, "right", end, end + 6), 1)
        self.assertEqual(self.planted(changed, "right", end, end + 6), 1)

    def test_the_sidecar_records_the_file_and_verify_needs_it(self):
        path = self.edits({"part": "left_foot", "action": "remove", "start": 0.5, "end": 0.8})
        motion, _, _ = self.solve("edited", "--sidecar", "--contact-edits", path)
        sidecar = self.folder / "edited.csv.json"
        self.assertIn("edits.json", sidecar.read_text())
        self.assert_done(self.run_tool("verify", sidecar))
        path.write_text(json.dumps({"contacts": []}))
        self.assertNotEqual(self.run_tool("verify", sidecar).returncode, 0)

    def test_an_empty_edit_list_has_no_effect(self):
        plain, _, _ = self.solve("plain")
        edited, _, _ = self.solve("edited", "--contact-edits", self.edits())
        self.assertEqual(plain.read_bytes(), edited.read_bytes())

    def refuse(self, code, words, *edits, arguments=()):
        done = self.retarget("--contact-edits", self.edits(*edits), *arguments, bvh=sample("walk"))
        self.assert_fails(done, code, *words)
        self.assertFalse((self.folder / "out.csv").exists())

    def test_an_edit_outside_the_clip_is_refused_with_a_hint(self):
        self.refuse(4, ["outside the motion", "first frame of the motion"],
                    {"part": "left_foot", "action": "add", "start": 1, "end": 1000})

    def test_unknown_parts_get_a_suggestion(self):
        self.refuse(4, ["left_foot"], {"part": "left_fot", "action": "add", "start": 0, "end": 1})

    def test_the_published_method_takes_no_edits(self):
        self.refuse(2, ["--contact-edits requires --method fit"], arguments=("--method", "gmr"))


if __name__ == "__main__":
    unittest.main()
