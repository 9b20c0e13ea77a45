"""`retarget view FOLDER`: pages of a batch and an index page."""

import hashlib
import json
import pathlib
import struct
import unittest

from galleries import GalleryTest, data_of
from tool import read_rows, short_clip


class Gallery(GalleryTest):
    def test_every_clip_has_its_page_and_the_worst_come_first(self):
        self.write("clips/broken.bvh", b"HIERARCHY\n")
        self.batch()
        self.assert_done(self.gallery())
        clips = self.index()["clips"]
        rows = (self.folder / "out/summary.csv").read_text().splitlines()[1:]
        summary = [row.split(",")[1] for row in rows]
        self.assertEqual([clip["name"] for clip in clips], summary)
        self.assertTrue(clips[0]["failed"])
        self.assertIn("broken.bvh", clips[0]["message"])
        self.assertNotIn("page", clips[0])
        entries = {entry["relative"]: entry for entry in self.entries()}
        metrics = [metric["key"] for metric in self.index()["metrics"]]
        pages = []
        for clip in clips[1:]:
            entry = entries[clip["name"]]
            self.assertEqual(clip["missed"], entry["quality"]["gates_missed"])
            figures = dict(zip(metrics, clip["figures"]))
            for key, value in entry["quality"]["figures"].items():
                near = max(1e-4, abs(value) * 6e-3)
                self.assertAlmostEqual(figures[key], value, delta=near, msg=key)
            page = self.folder / "gallery" / clip["page"]
            header = data_of(page, "page-header")
            self.assertEqual(header["motions"][0]["frames"], entry["frames"])
            self.assertIn("human", header["motions"][0])
            picture = (self.folder / "gallery" / clip["picture"]).read_bytes()
            width, height = struct.unpack_from(">II", picture, 16)
            self.assertLessEqual((width, height), (321, 120))
            pages.append((page.name, header["links"]))
        index = "../index.html"
        self.assertEqual(pages[0][1], {"index": index, "previous": "", "next": pages[1][0]})
        self.assertEqual(pages[1][1], {"index": index, "previous": pages[0][0], "next": ""})
        # A second run gives the same bytes and only these files.
        before = {f: (self.folder / f).read_bytes() for f in self.files() if f.startswith("gal")}
        self.assert_done(self.gallery())
        after = {f: (self.folder / f).read_bytes() for f in self.files() if f.startswith("gal")}
        self.assertEqual(before, after)

    def test_the_recorded_options_reproduce_the_interpretation_of_the_source(self):
        self.batch("--start", 0.5, "--csv-degrees", clips=("walk",))
        self.assert_done(self.gallery())
        header = data_of(self.folder / "gallery" / self.index()["clips"][0]["page"], "page-header")
        report = header["motions"][0]["report"]
        angle = next(figure["value"] for figure in report["figures"]
                     if figure["key"] == "limb_angle_deg")
        entry = self.entries()[0]["quality"]["figures"]["limb_angle_deg"]
        self.assertAlmostEqual(angle, entry, delta=0.3)

    def test_a_fixed_base_is_measured_as_in_the_batch(self):
        self.batch("--base", "fixed", clips=("walk",))
        self.assert_done(self.gallery())
        header = data_of(self.folder / "gallery" / self.index()["clips"][0]["page"], "page-header")
        shown = {figure["key"] for figure in header["motions"][0]["report"]["figures"]}
        recorded = set(self.entries()[0]["quality"]["figures"])
        self.assertNotIn("stance_slip_mean", recorded)
        self.assertEqual(shown & {"stance_slip_mean", "body_pen_cm_p99"}, set())

    def test_missing_motions_are_reported_and_the_others_are_shown(self):
        self.batch()
        (self.folder / "out/walk.csv").unlink()
        (self.folder / "clips/squat.bvh").unlink()
        with open(self.folder / "out/manifest.jsonl", "a") as manifest:
            manifest.write('{"relative": "torn')
        result = self.gallery()
        self.assert_done(result)
        self.assertIn("a motion of the manifest is missing: walk.csv", result.stderr)
        self.assertIn("1 line of the manifest cannot be read", result.stderr)
        self.assertIn("1 clip is shown without the source, which no longer exists", result.stderr)
        walk = next(clip for clip in self.index()["clips"] if clip["name"] == "walk.bvh")
        self.assertEqual(walk["message"], "the motion is missing: walk.csv")
        squat = next(clip for clip in self.index()["clips"] if clip["name"] == "squat.bvh")
        header = data_of(self.folder / "gallery" / squat["page"], "page-header")
        self.assertNotIn("human", header["motions"][0])
        # A changed source does not block the page.
        self.write("clips/squat.bvh", b"HIERARCHY\n")
        self.assert_done(self.gallery())
        squat = next(clip for clip in self.index()["clips"] if clip["name"] == "squat.bvh")
        self.assertIn("without its source", squat["message"])
        self.assertIn("page", squat)

    def test_parts_of_a_batch_that_has_not_been_merged(self):
        self.batch("--shard", "1/2")
        self.batch("--shard", "2/2")
        self.assertFalse((self.folder / "out/manifest.jsonl").exists())
        self.assert_done(self.gallery())
        self.assertEqual(len(self.index()["clips"]), 2)

    def test_unreadable_motion_has_a_page_with_the_reason(self):
        self.batch()
        self.write("out/walk.csv", "1,2,<b>3\n")
        result = self.gallery()
        self.assert_done(result)
        self.assertIn("1 motion cannot be shown", result.stderr)
        walk = next(clip for clip in self.index()["clips"] if clip["name"] == "walk.bvh")
        self.assertIn("walk.csv", walk["message"])
        page = (self.folder / "gallery" / walk["page"]).read_text()
        self.assertIn("walk.csv", page)
        self.assertIn("../index.html", page)
        self.assertNotIn("<b>3", page)

    def test_damaged_meshes_are_named_beside_the_clip(self):
        self.batch(clips=("walk",))
        self.write("meshes/left_knee_link.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.write("meshes/right_knee_link.obj", "v 0 0 0\nv 1 0 x\n")
        self.assert_done(self.gallery("--meshes", "meshes"))
        [clip] = self.index()["clips"]
        self.assertIn("the meshes of a body cannot be read: right_knee_link.obj", clip["message"])

    def header(self, clip):
        return data_of(self.folder / "gallery" / clip["page"], "page-header")

    def test_a_source_that_has_changed_is_not_shown(self):
        self.batch(clips=("walk", "squat"))
        # Another readable clip: only its content differs.
        self.write("clips/walk.bvh", short_clip("squat", 40))
        self.assert_done(self.gallery())
        clips = {clip["name"]: clip for clip in self.index()["clips"]}
        self.assertIn("the source has changed since", clips["walk.bvh"]["message"])
        header = self.header(clips["walk.bvh"])
        self.assertNotIn("human", header["motions"][0])
        self.assertIn("the source has changed since", header["title"])
        self.assertIn("human", self.header(clips["squat.bvh"])["motions"][0])
        self.assertNotIn("message", clips["squat.bvh"])

    def test_a_motion_that_has_changed_is_not_shown(self):
        self.batch()
        text = (self.folder / "out/squat.csv").read_text()
        self.write("out/walk.csv", text)
        self.assert_done(self.gallery())
        walk = next(clip for clip in self.index()["clips"] if clip["name"] == "walk.bvh")
        self.assertIn("the motion has changed since", walk["message"])
        self.assertNotIn("picture", walk)

    def test_paths_are_those_of_the_batchs_call_or_of_its_folder(self):
        self.batch(clips=("walk",))
        # Moved with its sources: the same names are found from the batch's folder.
        (self.folder / "clips").rename(self.folder / "out/clips")
        self.write("clips/walk.bvh", short_clip("squat", 40))
        self.assert_done(self.gallery())
        clip = self.index()["clips"][0]
        self.assertNotIn("message", clip)
        self.assertIn("human", self.header(clip)["motions"][0])

    def test_files_that_others_name_are_not_reported(self):
        self.batch(clips=("walk",))
        self.write("secret.txt", "HIERARCHY\nthe secret word\n")
        options = json.loads((self.folder / "out/options.json").read_text())
        entry = self.entries()[0]
        for role in ("map", "tpose-file", "limits", "smpl-model"):
            options[0]["paths"] = {role: "secret.txt"}
            options[0]["options"][role] = str(self.folder / "secret.txt")
            self.write("out/options.json", json.dumps(options))
            self.write_entries([entry])
            self.assert_done(self.gallery())
            message = self.index()["clips"][0]["message"]
            self.assertIn("a file named by the batch's options has changed since: secret.txt", message)
            for file in self.folder.glob("gallery/**/*.html"):
                self.assertNotIn("the secret", file.read_text(), role)
        options[0]["paths"] = {}
        self.write("out/options.json", json.dumps(options))
        self.write_entries([{**entry, "input": {**entry["input"], "file": "secret.txt"}}])
        self.assert_done(self.gallery())
        for file in self.folder.glob("gallery/**/*.html"):
            self.assertNotIn("the secret", file.read_text())

    def test_the_robot_of_the_call_is_for_its_own_motions(self):
        self.write("clips/walk.bvh", short_clip("walk", 40))
        self.run_tool("batch", "clips", "-o", "out", "--method", "gmr",
                      "--robot", "unitree_g1", "--robot", "booster_t1_29dof")
        self.assert_done(self.gallery("--robot", "unitree_g1"))
        clips = self.index()["clips"]
        self.assertEqual(sorted(clip["robot"] for clip in clips),
                         ["booster_t1_29dof", "unitree_g1"])
        for clip in clips:
            self.assertNotIn("message", clip)
            header = self.header(clip)
            robot = header["robots"][header["motions"][0]["robot"]]
            self.assertEqual(robot["name"], clip["robot"])
        self.assert_fails(self.run_tool("view", "out", "-o", "other", "--robot", "fourier_n1"), 2,
                          "no motions for the robot", "booster_t1_29dof, unitree_g1")
        self.assertFalse((self.folder / "other").exists())

    def test_the_recorded_options_determine_how_motions_are_read(self):
        self.batch(clips=("walk",))
        motion = self.folder / "out/walk.csv"
        rows = read_rows(motion.read_text())
        for row in rows:
            # On a high platform, as if in centimetres; a rotated arm, as if in degrees.
            row[2] += 30.0
            row[-1] += 12.56637
        motion.write_text("".join(",".join(map(repr, row)) + "\n" for row in rows))
        entry = self.entries()[0]
        content = motion.read_bytes()
        entry["outputs"][0].update(bytes=len(content),
                                   hash=f"sha256:{hashlib.sha256(content).hexdigest()}")
        self.write_entries([entry])
        self.assert_done(self.gallery())
        clip = self.index()["clips"][0]
        self.assertNotIn("message", clip)
        self.assertIn("picture", clip)

    def test_pages_of_an_earlier_gallery_are_removed(self):
        self.batch()
        self.assert_done(self.gallery())
        self.write("gallery/clips/notes.html", "my own")
        self.write_entries([e for e in self.entries() if e["relative"] == "walk.bvh"])
        self.assert_done(self.gallery())
        clip = self.index()["clips"][0]
        left = sorted(f.name for f in self.folder.glob("gallery/clips/*"))
        self.assertEqual(left, sorted(["notes.html", *(pathlib.Path(clip[key]).name
                                                       for key in ("page", "picture"))]))

    def test_no_folder_of_a_batch_becomes_a_gallery(self):
        self.write("clips/sub/walk.bvh", short_clip("walk", 40))
        self.batch("--shard", "1/1")
        self.write("parts/manifest.part_1_of_2.jsonl", "")
        before = self.files()
        for output in ("parts", "out", "out/sub", "clips", "clips/sub", "."):
            self.assert_fails(self.run_tool("view", "out", "-o", output), 2, "own files")
        self.assertEqual(self.files(), before)

    def test_faults_are_explained(self):
        self.batch(clips=("walk",))
        self.assert_fails(self.gallery(folder="clips"), 3, "manifest.jsonl")
        for output, word in (("page.html", "folder"), ("out/walk.csv", "folder"), ("-", "folder"),
                             ("out", "batch"), ("no/gallery", "no")):
            self.assert_fails(self.run_tool("view", "out", "-o", output), 2, word)
        self.assert_fails(self.gallery("--bvh", "clips/walk.bvh"), 2, "--bvh")
        self.assert_fails(self.run_tool("view", "out", "clips", "-o", "gallery"), 2, "one folder")
        self.assert_fails(self.gallery("--robot", "no_such_robot"), 4, "no_such_robot")
        self.assertFalse((self.folder / "gallery").exists())


if __name__ == "__main__":
    unittest.main()
