"""`retarget edit`: BVH in, BVH out."""

import math
import pathlib
import unittest

from tool import SHARED, ToolTest, difference, needs_shared, read_rows, sample


class Edit(ToolTest):
    def robot_rows(self, bvh, *options):
        # The fit amplifies the rounding of a BVH more than the published method.
        result = self.retarget("--precision", 9, "--method", "gmr", *options, bvh=bvh, output="-")
        self.assert_done(result)
        return read_rows(result.stdout)

    def edited(self, *arguments):
        result = self.run_tool("edit", *arguments, "-o", "edited.bvh")
        self.assert_done(result)
        return self.folder / "edited.bvh"

    def test_a_body_model_is_for_smpl_motions(self):
        self.assert_fails(self.run_tool("edit", "mirror", sample("walk"), "--smpl-model", "none.npz", "-o", "x.bvh"), 2,
                          "--smpl-model applies only to SMPL motions")

    def test_edits_without_effect_give_the_same_robot_motion(self):
        expected = self.robot_rows(sample("walk"))
        for arguments in (("rest", sample("walk"), "--like", sample("wave")),
                          ("transfer", sample("walk"), "--to", sample("squat")),
                          ("lafan", sample("walk"))):
            with self.subTest(edit=arguments[0]):
                self.assertIsNone(
                    difference(self.robot_rows(self.edited(*arguments)), expected, 1e-6))

    def test_faults_are_explained(self):
        walk = sample("walk")
        self.assert_fails(self.run_tool("edit", "rest", walk, "-o", "x.bvh"), 2, "--like")
        self.assert_fails(self.run_tool("edit", "lafan", walk), 2, "--output")
        self.assert_fails(self.run_tool("edit", walk), 2)
        # An empty word as a value: an unset shell variable.
        self.assert_fails(self.run_tool("edit", "path", walk, "-o", ""), 2, "empty")
        self.assert_fails(self.run_tool("edit", "trim", walk, "--frmes", ":9", "-o", "x.bvh"), 2,
                          "--frames")
        self.assert_fails(self.run_tool("edit", "move", walk, "1e300,0", "-o", "x.bvh"), 2, "X,Y")
        self.assert_fails(self.run_tool("edit", "lafan", "no.bvh", "-o", "x.bvh"), 3, "no.bvh")
        self.assert_fails(self.run_tool("edit", "lafan", walk, "-o", "no/x.bvh"), 2, "no")
        self.assertEqual(self.files(), [])

    def frames(self, bvh):
        text = pathlib.Path(bvh).read_text()
        rows = text[text.index("Frame Time"):].splitlines()[1:]
        return [[float(value) for value in row.split()] for row in rows if row]

    def said(self, *arguments):
        result = self.run_tool("edit", *arguments)
        self.assert_done(result)
        return result.stderr

    def test_time(self):
        walk = sample("walk")
        self.assertEqual(len(self.frames(self.edited("resample", walk, "--fps", 60))), 601)
        self.assertEqual(len(self.frames(self.edited("resample", walk, "--speed", 0.8))), 376)
        self.assertEqual(
            len(self.frames(self.edited("resample", walk, "--speed", 2, "--fps", 60))), 301)
        part = self.frames(self.edited("trim", walk, "--start", 2, "--end", 4))
        self.assertEqual(len(part), 61)
        # Angles may differ by whole turns.
        self.assertIsNone(difference([row[:3] for row in part],
                                     [row[:3] for row in self.frames(walk)[60:121]], 1e-6))
        self.assert_fails(self.run_tool("edit", "resample", walk, "-o", "x.bvh"), 2, "--fps")
        self.assert_fails(self.run_tool("edit", "trim", walk, "-o", "x.bvh"), 2, "--start")

    def test_place(self):
        walk = sample("walk")
        expected = self.frames(walk)
        turned = self.edited("turn", walk, "-90")
        turned.rename(self.folder / "turned.bvh")
        back = self.frames(self.edited("turn", "turned.bvh", "90"))
        self.assertIsNone(difference([row[:3] for row in back], [row[:3] for row in expected], 1e-6))
        moved = self.frames(self.edited("move", walk, "-1.5,0.25"))
        # x is x and y is -z of a y-up file in centimetres.
        self.assertAlmostEqual(moved[40][0] - expected[40][0], -150.0, 5)
        self.assertAlmostEqual(moved[40][2] - expected[40][2], -25.0, 5)
        self.assertIn("floor", self.said("ground", walk, "-o", "g.bvh"))
        mirrored = self.edited("mirror", walk)
        mirrored.rename(self.folder / "mirrored.bvh")
        twice = self.frames(self.edited("mirror", "mirrored.bvh"))
        self.assertIsNone(difference([row[:3] for row in twice], [row[:3] for row in expected], 1e-6))
        self.assert_fails(self.run_tool("edit", "move", walk, "1", "-o", "x.bvh"), 2, "X,Y")
        self.assert_fails(self.run_tool("edit", "turn", walk, "left", "-o", "x.bvh"), 2, "left")
        self.assert_fails(self.run_tool("edit", "turn", walk, "--degrees", "37", "-o", "x.bvh"), 2,
                          "degrees is given without a name", "retarget edit turn file degrees")

    def in_other_unit(self, bvh, factor):
        """Scales all lengths of a file."""
        lines, motion = [], False
        for line in pathlib.Path(bvh).read_text().splitlines():
            words = line.split()
            if motion and len(words) > 6:
                words[:3] = [repr(factor * float(word)) for word in words[:3]]
            elif words[:1] == ["OFFSET"]:
                words[1:] = [repr(factor * float(word)) for word in words[1:]]
            motion = motion or words[:2] == ["Frame", "Time:"]
            lines.append(" ".join(words))
        return self.write("other_unit.bvh", "\n".join(lines) + "\n")

    def test_edits_without_a_unit(self):
        walk = sample("walk")
        self.edited("mirror", walk).rename(self.folder / "mirrored.bvh")
        # Hips at 1.8 m in centimetres, at 4.6 m in inches.
        twice = self.in_other_unit(walk, 2.0)
        mirrored = self.frames(self.edited("mirror", twice))
        self.assertIsNone(difference(
            [[0.5 * value for value in row[:3]] + row[3:] for row in mirrored],
            self.frames(self.folder / "mirrored.bvh"), 1e-4))
        for arguments in (("turn", twice, "90"), ("ground", twice), ("lafan", twice),
                          ("transfer", twice, "--to", walk), ("transfer", walk, "--to", twice)):
            with self.subTest(edit=arguments[0]):
                self.assertIn("no known unit", self.said(*arguments, "-o", "done.bvh"))
        for arguments in (("move", twice, "1,0"), ("path", twice, "--to", "line")):
            with self.subTest(edit=arguments[0]):
                self.assert_fails(self.run_tool("edit", *arguments, "-o", "x.bvh"), 3, "--unit",
                                  "--height")
                self.said(*arguments, "--height", 1.75, "-o", "done.bvh")

    def test_loop(self):
        words = self.said("loop", sample("walk"), "--start", 3.4, "--end", 7, "--shortest", 0.6,
                          "--times", 3, "-o", "loop.bvh")
        cycle = int(words.split("cycle")[1].split()[0])
        self.assertEqual(len(self.frames(self.folder / "loop.bvh")), 3 * cycle)
        # The travelled distance is independent of the location in the world.
        advance = words.split("advance")[1].splitlines()[0]
        self.edited("turn", sample("walk"), "40").rename(self.folder / "turned.bvh")
        self.edited("move", "turned.bvh", "-40,90").rename(self.folder / "far.bvh")
        far = self.said("loop", "far.bvh", "--start", 3.4, "--end", 7, "--shortest", 0.6, "-o", "x.bvh")
        self.assertEqual(far.split("advance")[1].splitlines()[0], advance)
        # In the written motion.
        rows = self.frames(self.folder / "loop.bvh")
        way = [0.01 * (rows[cycle][i] - rows[0][i]) for i in (0, 2)]
        self.assertAlmostEqual(float(advance.split()[0]), (way[0] ** 2 + way[1] ** 2) ** 0.5, 3)
        # A run restores the advance of a cycle in place, unless it keeps the clip as it is.
        self.assertNotIn("--clean off", words)
        self.assertIn("--clean off", self.said("loop", sample("walk"), "--start", 3.4, "--end", 7, "--shortest", 0.6,
                                               "--times", 8, "--in-place", "-o", "in_place.bvh"))
        robot = self.retarget("--clean", "off", bvh=self.folder / "in_place.bvh", output="in_place.csv")
        self.assert_done(robot)
        places = [row[:2] for row in read_rows((self.folder / "in_place.csv").read_text())]
        self.assertLess(max(math.dist(place, places[0]) for place in places), 0.5)
        # A clip of getting up never returns to lying.
        up = sample("get_up")
        self.assert_fails(self.run_tool("edit", "loop", up, "-o", "x.bvh"), 1, "cm apart", "--force")
        self.said("loop", up, "--force", "-o", "x.bvh")

    def with_zeros_in_front(self, bvh, name="zeros.bvh", held=1):
        """Prepends frames without rotation, from which the motion jumps."""
        hierarchy, motion = pathlib.Path(bvh).read_text().split("MOTION")
        _, time, *rows = motion.strip().splitlines()
        first = rows[0].split()
        front = " ".join(first[:3] + ["0"] * (len(first) - 3))
        rows = held * [front] + rows
        return self.write(name, hierarchy + "\n".join(
            ["MOTION", f"Frames: {len(rows)}", time, *rows]) + "\n")

    def test_leading_frames_are_dropped(self):
        up, walk = sample("get_up"), sample("walk")
        zeros = self.with_zeros_in_front(up)
        for arguments in (("path", "--rotate", "30"), ("loop", "--force"), ("ground",),
                          ("path", "--rotate", "30", "--end", "3"),
                          ("loop", "--end", "3", "--force")):
            with self.subTest(edit=arguments):
                words = self.said(arguments[0], zeros, *arguments[1:], "-o", "one.bvh")
                self.assertRegex(words, r"lead-in +1 frame at the start skipped.*--start 0 keeps it")
                # Times refer to the file, which begins one frame earlier.
                plain = ["2.96667" if word == "3" else word for word in arguments]
                self.said(plain[0], up, *plain[1:], "-o", "other.bvh")
                self.assertIsNone(difference(self.frames(self.folder / "one.bvh"),
                                             self.frames(self.folder / "other.bvh"), 1e-6))
        # The path is not blamed for the jump, which is rare among many frames.
        self.assert_done(self.run_tool("edit", "resample", walk, "--fps", 150, "-o", "long.bvh"))
        rare = self.with_zeros_in_front(self.folder / "long.bvh", "rare.bvh")
        self.assertNotIn("warning", self.said("path", rare, "--to", "circle", "-o", "x.bvh"))
        several = self.with_zeros_in_front(walk, "several.bvh", held=20)
        self.assertRegex(self.said("ground", several, "-o", "x.bvh"),
                         r"lead-in +20 frames at the start skipped.*--start 0 keeps them")
        words = self.said("concat", several, several, "-o", "x.bvh")
        self.assertEqual(words.count("20 frames at the start skipped"), 2)
        self.assertNotIn("--start", words)
        # A given start is kept exactly, and an edit that changes every frame alike takes all
        # frames.
        count = len(self.frames(zeros))
        for arguments in (("ground", "--start", 0), ("ground", "--frames", "0:"), ("mirror",),
                          ("resample", "--speed", 1), ("turn", "90"), ("move", "1,0"), ("lafan",),
                          ("transfer", "--to", walk), ("rest", "--like", walk)):
            with self.subTest(edit=arguments):
                words = self.said(arguments[0], zeros, *arguments[1:], "-o", "all.bvh")
                self.assertNotIn("lead-in", words)
                self.assertEqual(len(self.frames(self.folder / "all.bvh")), count)

    def test_concat(self):
        walk = sample("walk")
        for name, part in (("a", ":160"), ("b", "150:")):
            self.assert_done(
                self.run_tool("edit", "trim", walk, "--frames", part, "-o", name + ".bvh"))
        words = self.said("concat", "a.bvh", "b.bvh", "--matrix", "d.pgm", "-o", "ab.bvh")
        self.assertIn("frame 150 ", words)
        joined = self.frames(self.folder / "ab.bvh")
        self.assertIsNone(difference([row[:3] for row in joined],
                                     [row[:3] for row in self.frames(walk)], 1e-6))
        self.assertTrue((self.folder / "d.pgm").read_bytes().startswith(b"P5\n"))
        # Three clips, one of them with another skeleton and rate.
        self.assert_done(self.run_tool("edit", "resample", sample("wave"), "--fps", 60, "-o", "w.bvh"))
        text = (self.folder / "w.bvh").read_text().replace("CHANNELS 3 Zrotation Yrotation Xrotation",
                                                           "CHANNELS 3 Zrotation Xrotation Yrotation")
        self.write("other.bvh", text)
        words = self.said("concat", "a.bvh", "b.bvh", "other.bvh", "--force", "-o", "abc.bvh")
        self.assertIn("60 to 30 fps", words)
        self.assertIn("T-pose", words)
        fails = self.run_tool("edit", "concat", walk, sample("get_up"), "--search", "0.2", "-o", "x.bvh")
        self.assert_fails(fails, 1, "cm apart", "--force")
        self.assert_fails(self.run_tool("edit", "concat", walk, "-o", "x.bvh"), 2, "two files")
        self.assert_fails(
            self.run_tool("edit", "concat", walk, walk, "--search", "x", "-o", "x.bvh"), 2, "--search")
        self.assert_fails(self.run_tool("edit", "concat", "-", "-", "-o", "x.bvh"), 2, "standard input")

    def test_the_move_of_a_seam_is_that_of_the_body(self):
        walk = sample("walk")
        self.assert_done(self.run_tool("edit", "trim", walk, "--frames", ":160", "-o", "a.bvh"))
        self.assert_done(self.run_tool("edit", "trim", walk, "--frames", "150:", "-o", "b.bvh"))
        self.edited("turn", "b.bvh", "50").rename(self.folder / "turned.bvh")
        self.edited("move", "turned.bvh", "60,-80").rename(self.folder / "far.bvh")
        words = self.said("concat", "a.bvh", "far.bvh", "-o", "ab.bvh")
        # The second clip begins at the seam: the body returns by its displacement.
        self.assertIn("rotated by -50 degrees", words)
        x, y = (float(word) for word in
                words.split("and moved by ")[1].split(" m")[0].split(", "))
        self.assertAlmostEqual(x, -60.0, 2)
        self.assertAlmostEqual(y, 80.0, 2)

    def test_a_clip_is_lowered_or_raised_to_the_first_ones_floor(self):
        walk = sample("walk")
        self.assert_done(self.run_tool("edit", "trim", walk, "--frames", ":160", "-o", "a.bvh"))
        for height, said in ((31.0, "lowered by 0.31"), (-31.0, "raised by 0.31")):
            hierarchy, motion = walk.read_text().split("MOTION")
            _, time, *rows = motion.strip().splitlines()
            words = [row.split() for row in rows[150:]]
            rows = [" ".join([row[0], repr(float(row[1]) + height), *row[2:]]) for row in words]
            b = self.write("b.bvh", hierarchy + "\n".join(
                ["MOTION", f"Frames: {len(rows)}", time, *rows]) + "\n")
            with self.subTest(height=height):
                self.assertIn(said, self.said("concat", "a.bvh", b, "-o", "ab.bvh"))

    def test_names_of_other_kinds_of_files_are_rejected(self):
        walk = sample("walk")
        for name in ("q.npz", "q.csv", "q.json", "q.HTML", "q.fbx", "q.gltf", "q.png"):
            with self.subTest(name=name):
                self.assert_fails(self.run_tool("edit", "mirror", walk, "-o", name), 2,
                                  "which is a BVH file or a GLB", "use one of .bvh, .glb")
        for options, kind in ((("--fit", "p.csv"), "a path in JSON"),
                              (("--svg", "p.pdf"), "in the format SVG")):
            self.assert_fails(self.run_tool("edit", "path", walk, *options), 2, kind)
        self.assert_fails(self.run_tool("edit", "concat", walk, walk, "-o", "x.bvh", "--matrix",
                                        "d.png"), 2, "in the format PGM")
        self.assertEqual(self.files(), [])
        # Extensions of no known kind, and none at all, remain allowed.
        for name in ("mirrored", "mirrored.backup"):
            self.assert_done(self.run_tool("edit", "mirror", walk, "-o", name))

    def test_rejected_seam_writes_its_image(self):
        fails = self.run_tool("edit", "concat", sample("walk"), sample("get_up"), "--search", "0.2",
                              "--matrix", "d.pgm", "-o", "x.bvh")
        self.assert_fails(fails, 1, "cm apart")
        self.assertEqual(self.files(), ["d.pgm"])
        # Without search options, the seam after lying is found.
        words = self.said("concat", sample("walk"), sample("get_up"), "-o", "x.bvh")
        self.assertIn("meets frame", words)

    def test_parts_that_share_no_frame(self):
        walk = sample("walk")
        for name, part in (("a", ":150"), ("b", "150:")):
            self.assert_done(
                self.run_tool("edit", "trim", walk, "--frames", part, "-o", name + ".bvh"))
        self.assertIn("continues", self.said("concat", "a.bvh", "b.bvh", "-o", "ab.bvh"))
        self.assertIsNone(difference([row[:3] for row in self.frames(self.folder / "ab.bvh")],
                                     [row[:3] for row in self.frames(walk)], 1e-6))

    def test_path(self):
        walk = sample("walk")
        self.said("path", walk, "--fit", "path.json", "--svg", "path.svg")
        self.assertTrue((self.folder / "path.svg").read_text().startswith("<svg"))
        same = self.robot_rows(self.edited("path", walk, "--to", "path.json"))
        self.assertIsNone(difference(same, self.robot_rows(walk), 1e-6))
        for to in (["--to", "circle", "--radius", "-2"], ["--to", "figure8", "--keep", "stride"],
                   ["--to", "line", "--scale", "0.8", "--keep", "speed"], ["--rotate", "30"]):
            with self.subTest(to=to):
                self.edited("path", walk, *to, "--svg", "new.svg")
        # The motion on its new path is retargeted like any other.
        self.edited("path", walk, "--to", "circle")
        self.assertEqual(len(self.robot_rows(self.folder / "edited.bvh")), 301)
        self.assert_fails(self.run_tool("edit", "path", walk), 2, "--fit")
        self.assert_fails(self.run_tool("edit", "path", walk, "-o", "x.bvh"), 2, "--to")
        self.assert_fails(self.run_tool("edit", "path", walk, "--to", "no.json", "-o", "x.bvh"), 4,
                          "no.json")
        self.write("bad.json", '{"control_points": [[0, 0]]}')
        self.assert_fails(self.run_tool("edit", "path", walk, "--to", "bad.json", "-o", "x.bvh"), 4,
                          "3n + 1")

    def test_transfer_carries_or_names_all_joints(self):
        # The walk with a finger below its last joint, which bends.
        text = sample("walk").read_text()
        hierarchy, motion = text.split("MOTION")
        finger = ("JOINT RightIndex\n{\nOFFSET 8 1 0\n"
                  "CHANNELS 3 Zrotation Yrotation Xrotation\nEnd Site\n{\nOFFSET 4 0 0\n}\n}\n")
        at = hierarchy.rindex("End Site")
        rows = motion.strip().splitlines()
        rows = rows[:2] + [row + f" {10 + i % 40} 5 0" for i, row in enumerate(rows[2:])]
        fingered = self.write("fingered.bvh", hierarchy[:at] + finger + hierarchy[at:] +
                              "MOTION\n" + "\n".join(rows) + "\n")
        words = self.said("transfer", fingered, "--to", fingered, "-o", "same.bvh")
        self.assertNotIn("left out", words)
        self.assertIsNone(difference([row[-3:] for row in self.frames(self.folder / "same.bvh")],
                                     [row[-3:] for row in self.frames(fingered)], 1e-6))
        words = self.said("transfer", fingered, "--to", sample("walk"), "-o", "x.bvh")
        self.assertIn("left out", words)
        self.assertIn("RightIndex", words)
        words = self.said("transfer", sample("walk"), "--to", fingered, "-o", "x.bvh")
        self.assertIn("at rest", words)
        self.assertIn("RightIndex", words)

    @needs_shared
    def test_other_skeletons(self):
        dialects = SHARED / "data/dialects"
        source = dialects / "games105_walk60.bvh"
        shaped = self.edited("lafan", source)
        self.assertIn("JOINT Spine2", shaped.read_text())
        self.assertEqual(len(self.robot_rows(shaped)), len(self.robot_rows(source)))
        self.edited("transfer", sample("walk"), "--to", source)
        # A run in an A-pose skeleton is transferred to the T-pose one with the same bones.
        result = self.run_tool("edit", "rest", dialects / "games105_run_forward.bvh", "--like",
                               source, "-o", "t.bvh")
        self.assert_done(result)


if __name__ == "__main__":
    unittest.main()
