"""Any human skeleton: recognition, overrides, refusals. Differently stored copies of one movement
give one robot motion."""

import json
import math
import re
import unittest

from tool import SHARED, ToolTest, difference, needs_shared, read_rows, sample

NUMBER = r"-?\d+(?:\.\d+)?"


def parts(name):
    """Hierarchy, header of the motion, rows."""
    hierarchy, motion = sample(name).read_text().split("MOTION\n")
    lines = motion.splitlines()
    return hierarchy, lines[:2], [line.split() for line in lines[2:] if line.strip()]


def joined(hierarchy, header, rows):
    return "MOTION\n".join(
        [hierarchy, "\n".join(header + [" ".join(row) for row in rows]) + "\n"])


def scaled(name, factor):
    """Scales offsets and root positions."""
    hierarchy, header, rows = parts(name)
    hierarchy = re.sub(
        rf"OFFSET ({NUMBER}) ({NUMBER}) ({NUMBER})",
        lambda m: "OFFSET " + " ".join(repr(float(v) * factor) for v in m.groups()), hierarchy)
    rows = [[repr(float(v) * factor) for v in row[:3]] + row[3:] for row in rows]
    return joined(hierarchy, header, rows)


def under_a_root(name, turns):
    """Places the tree below another joint, rotated about z, y, x by the given degrees."""
    hierarchy, header, rows = parts(name)
    hierarchy = re.sub(
        r"ROOT Hips",
        "ROOT Reference\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Yrotation Xrotation\nJOINT Hips",
        hierarchy) + "}\n"
    return joined(hierarchy, header, [list(turns) + row for row in rows])


def renamed(name, pattern):
    hierarchy, header, rows = parts(name)
    hierarchy = re.sub(r"(ROOT|JOINT) (\S+)", lambda m: m[1] + " " + pattern(m[2]), hierarchy)
    return joined(hierarchy, header, rows)


class OneMovementStoredDifferently(ToolTest):
    # The human is the same to the last printed digits. Only the published method, which has no
    # contacts that begin or end, is continuous to that degree.
    def rows_of(self, text, *options):
        result = self.retarget("--precision", 9, "--method", "gmr", *options,
                               bvh=self.write("twin.bvh", text), output="-")
        self.assert_done(result)
        return read_rows(result.stdout)

    def assert_twin(self, name, text, *options):
        original = self.retarget("--precision", 9, "--method", "gmr", *options, bvh=sample(name),
                                 output="-")
        self.assert_done(original)
        self.assertIsNone(difference(self.rows_of(text, *options), read_rows(original.stdout),
                                     1e-6))

    def test_units(self):
        for factor in (0.01, 10.0, 1 / 2.54):
            with self.subTest(factor=factor):
                self.assert_twin("walk", scaled("walk", factor))

    def test_z_up_and_a_joint_above_the_hips(self):
        for name in ("walk", "get_up"):
            with self.subTest(sample=name):
                self.assert_twin(name, under_a_root(name, ("0", "0", "90")))
                self.assert_twin(name, under_a_root(name, ("0", "0", "0")))

    def test_worlds_that_are_not_level(self):
        tilted = self.write("leaning.bvh", under_a_root("walk", ("0", "0", "20")))
        result = self.retarget("--method", "gmr", bvh=tilted)
        self.assert_done(result)
        warning = re.search(r"warning: the floor is tilted by 20 degrees: .*(--up \S+) levels", result.stderr)
        self.assertIsNotNone(warning, result.stderr)
        up = warning[1].split()
        levelled = self.retarget("--precision", 9, "--method", "gmr", *up, bvh=tilted)
        self.assert_done(levelled)
        self.assertNotIn("is tilted", levelled.stderr)
        self.assertIn("up +y levelled by", levelled.stderr)
        judged = self.run_tool("evaluate", "out.csv", "--robot", "unitree_g1", "--bvh", tilted, *up)
        self.assertIn("levelled by", judged.stderr)
        self.assertNotIn("is tilted", judged.stderr)
        y, z = math.cos(math.radians(20)), math.sin(math.radians(20))
        original = self.retarget("--precision", 9, "--method", "gmr", bvh=sample("walk"), output="-")
        self.assertIsNone(difference(self.rows_of(tilted.read_text(), "--up", f"0,{y!r},{z!r}"),
                                     read_rows(original.stdout), 1e-6))
        # An axis does not level the world.
        stated = self.retarget("--method", "gmr", "--up", "y", bvh=tilted)
        self.assertIn("is tilted", stated.stderr)

    def test_a_tilt_found_by_balance_is_approximate(self):
        tilted = self.write("leaning.bvh", under_a_root("wave", ("0", "0", "20")))
        result = self.retarget("--method", "gmr", bvh=tilted)
        self.assert_done(result)
        self.assertRegex(result.stderr, r"is tilted by about \d+ degrees: .*--up \S+ levels the clip to within about 8")

    def test_prefixes_of_names(self):
        self.assert_twin("walk", renamed("walk", lambda joint: "Actor1:" + joint))
        self.assert_twin("walk", renamed("walk", lambda joint: "actor_" + joint))

    def test_half_the_rate(self):
        hierarchy, header, rows = parts("wave")
        half = joined(hierarchy, [f"Frames: {len(rows[::2])}", "Frame Time: 0.0666666666667"],
                      rows[::2])
        found = self.rows_of(half, "--fps", "source")
        result = self.retarget("--precision", 9, "--method", "gmr", "--no-antialias", "--fps", 15,
                               output="-")
        self.assert_done(result)
        self.assertIsNone(difference(found, read_rows(result.stdout), 1e-6))


class WhatIsUnderstood(ToolTest):
    def inspect(self, file, *options):
        result = self.run_tool("inspect", "--json", file, *options)
        self.assert_done(result)
        return json.loads(result.stdout)

    def test_inspect_reports_the_recognised_skeleton(self):
        report = self.inspect(sample("walk"))
        self.assertEqual(report["dialect"], "lafan1")
        self.assertEqual(report["confidence"], 1)
        self.assertEqual(report["mapping"]["LeftUpLeg"], "LeftUpLeg")
        self.assertEqual((report["unit"], report["up"], report["height_m"], report["rest_pose"]),
                         ("cm", "+y", 1.75, "lafan1"))

    def test_inspect_also_shows_other_skeletons(self):
        file = self.write("chain.bvh", "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Xrotation "
                          "Yrotation Zrotation\nJOINT b\n{\nOFFSET 0 1 0\nCHANNELS 0\n}\n}\n"
                          "MOTION\nFrames: 1\nFrame Time: 0.1\n0 0 0\n")
        report = self.inspect(file)
        self.assertIsNone(report["dialect"])
        self.assertIn("not a human skeleton", report["not_understood"])
        self.assert_fails(self.retarget(bvh=file), 3, "not a human skeleton")
        self.assertEqual(self.files(), ["chain.bvh"])

    def test_a_bone_map_is_written_edited_and_used(self):
        walk = sample("walk")
        self.assert_done(self.retarget("--write-map", "map.json", bvh=walk, output="a.csv"))
        bone_map = json.loads((self.folder / "map.json").read_text())
        self.assertIn("LeftForeArm", json.dumps(bone_map))
        self.assert_done(self.retarget("--map", "map.json", bvh=walk, output="b.csv"))
        self.assertEqual((self.folder / "a.csv").read_bytes(), (self.folder / "b.csv").read_bytes())
        # A map that only omits bones keeps the profile of the skeleton.
        self.write("map.json", json.dumps({**bone_map, "Spine1": None}))
        report = self.inspect(walk, "--map", "map.json")
        self.assertEqual((report["dialect"], report["rest_pose"]), ("lafan1", "lafan1"))
        other = {**bone_map, "Spine": bone_map["Spine1"], "Spine1": bone_map["Spine"]}
        self.write("map.json", json.dumps({**other, "Spine1": None}))
        self.assertEqual(self.inspect(walk, "--map", "map.json")["dialect"], "map file")
        self.write("map.json", json.dumps(bone_map).replace('"LeftFoot"', '"LeftFot"', 2))
        self.assert_fails(self.retarget("--map", "map.json", bvh=walk), 4, "map.json")

    def test_a_body_without_arms(self):
        hierarchy, header, rows = parts("walk")
        # Arms come last, and so do their columns.
        cut = hierarchy[:hierarchy.index("JOINT LeftShoulder")]
        depth = cut.count("{") - cut.count("}")
        columns = sum(int(n) for n in re.findall(r"CHANNELS (\d)", cut))
        file = self.write("armless.bvh", joined(cut + "}\n" * depth, header,
                                                [row[:columns] for row in rows]))
        self.assert_fails(self.retarget(bvh=file), 3, "no arms", "--partial")
        result = self.retarget("--partial", bvh=file)
        self.assert_done(result)
        self.assertIn("no arms", result.stderr)

    def test_a_clip_of_one_pose_is_reported(self):
        hierarchy, header, rows = parts("wave")
        still = joined(hierarchy, ["Frames: 30", header[1]], [rows[0]] * 30)
        for motion, expected in ((still, self.assertIn), (sample("wave").read_text(), self.assertNotIn)):
            result = self.retarget(bvh=self.write("still.bvh", motion))
            self.assert_done(result)
            expected("warning: no arm and no leg moves in the whole clip", result.stderr)

    def test_given_options_override_the_calibration(self):
        report = self.inspect(sample("walk"), "--height", "1.9", "--up", "z", "--unit", "0.02")
        self.assertEqual((report["height_m"], report["up"], report["metres_per_unit"]),
                         (1.9, "+z", 0.02))
        report = self.inspect(sample("walk"), "--rest", "learned")
        self.assertEqual(report["rest_pose"], "learned")
        report = self.inspect(sample("walk"), "--tpose-frame", "3")
        self.assertEqual(report["rest_pose"], "frame 3")

    def test_given_axes_that_disagree_are_reported(self):
        for options, words in (
                (("--up", "z"), "without --up, retarget finds +y as the up axis, not +z"),
                (("--unit", "cm", "--up", "z"), "without --up, retarget finds +y"),
                (("--forward", "z"), "without --forward, retarget finds that the rest pose faces +x, not +z"),
                (("--forward", "-x"), "without --forward, retarget finds that the rest pose faces +x, not -x"),
                (("--up", "y", "--forward", "x"), None)):
            with self.subTest(options=options):
                doubts = "\n".join(self.inspect(sample("walk"), *options)["doubts"])
                if words:
                    self.assertIn(words, doubts)
                else:
                    self.assertNotIn("without --", doubts)
        result = self.retarget("--method", "gmr", "--up", "z")
        self.assertRegex(result.stderr, "warning: without --up, retarget finds [+]y as the up axis, not [+]z: ")

    def test_two_motions_are_an_error(self):
        self.assert_fails(self.retarget("--smpl", "x.npz"), 2, "--bvh", "--smpl")

    def test_wrong_values_are_explained(self):
        for options, words in (
                (("--unit", "ell"), ("--unit", "cm")), (("--up", "w"), ("--up",)), (("--up", "0,0,0"), ("0,0,0",)), (("--up", "0,1"), ("0.1,0.99,0",)),
                (("--up", "y", "--forward", "-y"), ("forward",)),
                (("--rest", "first", "--tpose-frame", "1"), ("--rest", "--tpose-frame")),
                (("--tpose-frame", "100000"), ("100000",)),
                (("--height", "0"), ("0.1",)), (("--rest", "crouch"), ("crouch",))):
            with self.subTest(options=options):
                self.assert_fails(self.retarget(*options), 2, *words)
        self.assertEqual(self.files(), [])


@needs_shared
class SharedFiles(ToolTest):
    REFUSED = {"nonhuman_dog", "full_precision_frame_time", "rotation_first_root",
               "slimevr_hmd_root"}

    def test_every_human_runs_without_an_option(self):
        files = [*(SHARED / "data/dialects").glob("*.bvh"),
                 *(SHARED / "data/lafan1_cuts").glob("*.bvh")]
        for file in sorted(files):
            with self.subTest(file=file.name):
                result = self.retarget(bvh=file)
                if file.stem in self.REFUSED:
                    self.assert_fails(result, 3)
                else:
                    self.assert_done(result)
                    self.assertRegex(result.stderr, r"taken as \S+")
        headset = SHARED / "data/dialects/slimevr_hmd_root.bvh"
        self.assert_done(self.retarget("--partial", bvh=headset))

    def test_smpl_motions(self):
        for file in sorted((SHARED / "data/smpl").glob("*.npz")):
            with self.subTest(file=file.name):
                result = self.run_tool("--smpl", file, "--robot", "unitree_g1", "-o", "smpl.csv")
                self.assert_done(result)
                self.assertIn("generic body", result.stderr)
                # Recognised by content if named without an option.
                self.assert_done(self.run_tool(file, "g1", "-o", "word.csv"))
                self.assertEqual((self.folder / "word.csv").read_bytes(),
                                 (self.folder / "smpl.csv").read_bytes())
                heights = [row[2] for row in read_rows((self.folder / "smpl.csv").read_text())]
                self.assertTrue(0.5 < min(heights) and max(heights) < 1.2, heights)


if __name__ == "__main__":
    unittest.main()
