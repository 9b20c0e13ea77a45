"""--clean: noise of video estimates and IMU suits is removed, clean clips do not change."""

import json
import math
import unittest

import noise
from tool import SAMPLES, SHARED, ToolTest, needs_shared, sample

KEYPOINT_RATE = ("--source-fps", "30")


class Clean(ToolTest):
    def noisy(self, name, *changes):
        """A sample with noise, as a file."""
        motion = noise.Motion(sample(name))
        for change in changes:
            change(motion)
        return self.write("noisy.bvh", motion.text())

    def keypoints(self, name, **noises):
        """A sample as a file of noisy joint positions, and the options for reading it."""
        motion = noise.Motion(sample(name))
        names = self.write("names.txt", "".join(f"{joint['name']}\n" for joint in motion.joints))
        source = self.write("points.npy", noise.npy(noise.keypoints(motion, **noises)))
        return source, "--joint-names", names, *KEYPOINT_RATE

    def run_on(self, source, *options, output="out.csv"):
        """Runs without dynamics, which would hide a part of the noise from the figures."""
        plain = () if "--method" in options else ("--without", "dynamics")
        result = self.run_tool(source, "unitree_g1", "-o", output, *plain, *options)
        self.assert_done(result)
        return result.stderr

    def figures(self, name, output="out.csv", *options):
        """Figures of a motion, compared with the clean sample."""
        result = self.run_tool("evaluate", output, "--robot", "unitree_g1", "--bvh", sample(name),
                               "--source-quat", "xyzw", "--gate", "none", "--json", "-", *options)
        self.assert_done(result)
        return json.loads(result.stdout)["motions"][0]

    def joint_error(self, output):
        """RMS difference of the joint angles of a motion from those of clean.csv."""
        rows = []
        for name in (output, "clean.csv"):
            lines = (self.folder / name).read_text().splitlines()
            rows.append([[float(value) for value in line.split(",")[7:]]
                         for line in lines if line[0] in "-0123456789"])
        squares = [(a - b) ** 2 for one, other in zip(*rows) for a, b in zip(one, other)]
        return math.sqrt(sum(squares) / len(squares))

    def test_clean_clips_keep_every_byte(self):
        for name in SAMPLES:
            said = self.run_on(sample(name), output="auto.csv")
            self.assertNotIn("cleaned", said, name)
            self.run_on(sample(name), "--clean", "off", output="off.csv")
            auto, off = ((self.folder / f"{how}.csv").read_bytes() for how in ("auto", "off"))
            self.assertEqual(auto, off, name)

    def test_lost_frames_at_the_end_are_skipped(self):
        whole = noise.Motion(sample("walk"))
        for lost in (1, 3):
            with self.subTest(lost=lost):
                motion = noise.Motion(sample("walk"))
                motion.rows[-lost:] = [[0.0] * len(row) for row in motion.rows[-lost:]]
                said = self.run_on(self.write("lost.bvh", motion.text()))
                self.assertRegex(said, f"end +{lost} frames? at the end skipped")
                self.assertNotIn("warning", said)
                motion.rows = whole.rows[:-lost]
                self.run_on(self.write("shorter.bvh", motion.text()), output="shorter.csv")
                self.assertEqual(len(self.rows("out.csv")), len(whole.rows) - lost)
                for one, other in zip(self.rows("out.csv"), self.rows("shorter.csv")):
                    for a, b in zip(one, other):
                        self.assertAlmostEqual(a, b, delta=0.001)
        self.run_on("lost.bvh", "--clean", "off")
        self.assertEqual(len(self.rows("out.csv")), len(whole.rows))

    def rows(self, name):
        return [[float(value) for value in line.split(",")]
                for line in (self.folder / name).read_text().splitlines()
                if line[0] in "-0123456789"]

    def test_the_mirror_image_of_a_cleaned_clip_is_that_of_its_file(self):
        source = self.noisy("walk", lambda m: noise.root_noise(m, 0.15, 0.06))
        self.assertIn("cleaned  the root moved", self.run_on(source, "--mirror"))
        self.assert_done(self.run_tool("edit", "mirror", source, "-o", "mirrored.bvh"))
        self.run_on("mirrored.bvh", output="of_file.csv")
        rows = [[[float(value) for value in line.split(",")]
                 for line in (self.folder / name).read_text().splitlines()]
                for name in ("out.csv", "of_file.csv")]
        for one, other in zip(*rows, strict=True):
            self.assertLess(math.dist(one[:3], other[:3]), 0.002)

    def test_noise_of_the_root_is_undone(self):
        cases = {
            "depth and height": lambda m: noise.root_noise(m, 0.15, 0.06),
            "sway": lambda m: noise.sway(m, 0.2),
            "height of 2 cm": lambda m: noise.root_noise(m, 0.0, 0.02),
            "floor drift": lambda m: noise.floor_drift(m, 0.3),
            "slow floor drift": lambda m: noise.floor_drift(m, 0.1),
        }
        self.run_on(sample("walk"), output="clean.csv")
        clean = self.figures("walk", "clean.csv", "--dynamics")
        for what, change in cases.items():
            with self.subTest(what):
                said = self.run_on(self.noisy("walk", change))
                self.assertIn("cleaned  the root moved by up to", said)
                self.assertIn("--clean off uses the clip unchanged", said)
                found = self.figures("walk", "out.csv", "--dynamics")
                self.assertLess(abs(found["sole_height_p50_cm"]), 0.5)
                self.assertLess(found["contact_slip_p95"], 0.01)
                self.assertLess(found["float_planted_pct"], 2.0)
                self.assertLess(found["dynamics_bad_pct"], 1.2 * clean["dynamics_bad_pct"])
                self.assertLess(found["limb_angle_deg"][0], clean["limb_angle_deg"][0] + 1.0)

    def test_without_cleaning_feet_hover_and_slide(self):
        self.run_on(self.noisy("walk", lambda m: noise.root_noise(m, 0.15, 0.06)),
                    "--clean", "off")
        found = self.figures("walk")
        self.assertGreater(found["sole_height_p50_cm"], 4.0)
        self.assertGreater(found["contact_slip_p95"], 0.3)

    def test_jitter_of_joints_is_smoothed(self):
        said = self.run_on(self.noisy("squat", lambda m: noise.rotation_noise(m, 3.0),
                                      lambda m: noise.root_noise(m, 0.05, 0.02)))
        self.assertIn("cleaned  jitter of 1.", said)
        found = self.figures("squat", "out.csv", "--dynamics")
        self.assertLess(abs(found["sole_height_p50_cm"]), 0.5)
        self.assertLess(found["contact_slip_p95"], 0.01)
        self.assertLess(found["dynamics_bad_pct"], 5.0)
        # The noise floor: signals below the frequencies of the movement remain.
        self.assertLess(found["limb_angle_deg"][0], 5.0)

    def test_white_noise_is_only_smoothed(self):
        self.run_on(sample("walk"), output="clean.csv")
        for degrees in (0.35, 0.9, 1.7, 3.5):
            with self.subTest(degrees=degrees):
                source = self.noisy("walk", lambda m: noise.rotation_noise(m, degrees, seconds=1e-6))
                said = self.run_on(source)
                self.assertIn("cleaned  jitter of", said)
                self.assertNotIn("feet held", said)
                self.assertNotIn("root moved", said)
                self.run_on(source, "--clean", "off", output="off.csv")
                self.assertLess(self.joint_error("out.csv"), self.joint_error("off.csv"))

    def test_frames_of_a_slower_recording_are_no_jitter(self):
        def repeat(motion):
            motion.rows = [motion.rows[i - i % 2] for i in range(len(motion.rows))]

        for name in ("walk", "squat"):
            said = self.run_on(self.noisy(name, repeat))
            self.assertIn("repeated frames interpolated", said)
            self.assertNotIn("jitter", said)

    def test_feet_are_held_where_joints_jitter(self):
        clean = {}
        for name in ("walk", "get_up", "turn_in_place"):
            self.run_on(sample(name), output="clean.csv")
            clean[name] = self.figures(name, "clean.csv", "--dynamics")
        # limb angle: the slow noise of the limbs; off: the increase of bad frames, percent
        cases = (("walk", 3.0, 0.01, 5.5, 0.0), ("get_up", 3.0, 0.01, 9.5, 0.0),
                 ("turn_in_place", 3.0, 0.01, 6.0, 6.0), ("get_up", 7.0, 0.05, 15.0, 2.0))
        for name, degrees, slip, angle, more in cases:
            with self.subTest(name=name, degrees=degrees):
                said = self.run_on(self.noisy(name, lambda m: noise.rotation_noise(m, degrees)))
                self.assertRegex(said, r"\d+ stances of feet held: the legs turn")
                found = self.figures(name, "out.csv", "--dynamics")
                self.assertLess(abs(found["sole_height_p50_cm"]), 0.5)
                self.assertLess(found["contact_slip_p95"], slip)
                self.assertLess(found["limb_angle_deg"][0], angle)
                self.assertLess(found["dynamics_bad_pct"],
                                2.0 * clean[name]["dynamics_bad_pct"] + more)

    def test_strong_noise_of_keypoints(self):
        # Hands and knees that are held on the floor leave the feet of a noisy get_up a little less still.
        for name, slip, angle in (("walk", 0.01, 10.0), ("squat", 0.01, 11.5), ("get_up", 0.012, 13.5)):
            with self.subTest(name):
                self.run_on(*self.keypoints(name, white=0.03, slow=0.03))
                found = self.figures(name)
                self.assertLess(abs(found["sole_height_p50_cm"]), 0.5)
                self.assertLess(found["contact_slip_p95"], slip)
                self.assertLess(found["limb_angle_deg"][0], angle)

    def test_low_outliers_do_not_lower_the_floor(self):
        # In the walk with seed 7 and get_up with seed 8, the lowest feet are far below standing ones.
        cases = (("walk", 0.03, 7), ("walk", 0.03, 6), ("squat", 0.03, 3), ("get_up", 0.03, 8),
                 ("walk", 0.015, 1))
        for name, metres, seed in cases:
            with self.subTest(name=name, metres=metres, seed=seed):
                self.run_on(*self.keypoints(name, white=metres, slow=metres, seed=seed))
                found = self.figures(name)
                self.assertLess(found["contact_slip_p95"], 0.02)
                self.assertLess(abs(found["sole_height_p50_cm"]), 0.5)

    @needs_shared
    def test_corrections_that_lose_contacts_are_discarded(self):
        motion = noise.Motion(SHARED / "data/lafan1_cuts/run2_subject4_run.bvh")
        motion.rows = motion.rows[:1500]
        source = self.write("run.bvh", motion.text())
        noise.rotation_noise(motion, 3.0)
        noisy = self.write("noisy.bvh", motion.text())
        self.assertNotIn("root moved", self.run_on(noisy))
        result = self.run_tool("evaluate", "out.csv", "--robot", "unitree_g1", "--bvh", source,
                               "--source-quat", "xyzw", "--gate", "none", "--json", "-")
        self.assert_done(result)
        found = json.loads(result.stdout)["motions"][0]
        self.assertLess(abs(found["sole_height_p50_cm"]), 2.0)

    def test_frozen_frames_and_lost_joints_are_bridged(self):
        said = self.run_on(self.noisy("walk", noise.frozen_frames))
        self.assertIn("cleaned  20 frozen frames bridged", said)
        said = self.run_on(self.noisy("walk", lambda m: noise.lost_joint(m, "LeftForeArm")))
        self.assertRegex(said, r"cleaned  LeftForeArm was lost in \d+ frames: bridged")

    def test_manifests_have_the_corrections(self):
        self.noisy("walk", noise.frozen_frames, lambda m: noise.lost_joint(m, "LeftForeArm"))
        self.assert_done(self.run_tool("batch", "noisy.bvh", "-o", "out", "--robot", "unitree_g1",
                                       "--no-quality", "--without", "dynamics"))
        notes = json.loads((self.folder / "out/manifest.jsonl").read_text())["notes"]
        self.assertTrue(any("frozen frames bridged" in note for note in notes), notes)
        self.assertTrue(any("LeftForeArm was lost" in note for note in notes), notes)

    def test_long_freezes_are_kept_with_a_warning(self):
        said = self.run_on(self.noisy("walk", lambda m: noise.frozen_frames(m, 1, 40)))
        self.assertRegex(said, r"warning: the source stops abruptly in frames \d+ to \d+ and moves "
                               r"on abruptly.*: 40 equal frames kept, 1.33 s")
        self.assertNotIn("frozen frames bridged", said)

    def test_joints_that_are_lost_in_single_frames(self):
        def lose_joints(motion):
            for seed, joint in enumerate(motion.joints[1:]):
                noise.lost_joint(motion, joint["name"], seed=seed)

        said = self.run_on(self.noisy("walk", lose_joints))
        self.assertRegex(said, r"LeftLeg was lost in \d+ frames: bridged")
        self.assertLess(self.figures("walk")["contact_slip_p95"], 0.01)

    def test_a_missing_root_is_no_drift(self):
        def lose_root(motion):
            for row in motion.rows:
                row[:3] = [0.0, 0.0, 0.0]

        for name in ("walk", "squat"):
            said = self.run_on(self.noisy(name, lose_root))
            self.assertIn("the planted feet move and the root does not", said)
            self.assertIn("its height was restored from the lowest part of the body", said)
            self.assertNotIn("cleaned", said)
            # A squat has no path over the ground that could be missing.
            if name == "walk":
                self.assertRegex(said, r"missed   .*source_slide_mean")
            else:
                self.assertLess(self.figures(name)["sole_height_p50_cm"], 0.5)

    def test_keypoints(self):
        for lost in (0.0, math.nan):
            with self.subTest(lost=lost):
                said = self.run_on(*self.keypoints("squat", white=0.01, slow=0.01, dropouts=0.03,
                                                   lost=lost))
                self.assertRegex(said, r"22 joints untracked|21 joints untracked")
                self.assertRegex(said, r"cleaned  jitter of [\d.]+ % of the body size per frame")
                found = self.figures("squat")
                self.assertLess(abs(found["sole_height_p50_cm"]), 0.5)
                self.assertLess(found["contact_slip_p95"], 0.05)

    def test_published_method_does_not_clean(self):
        source = self.noisy("squat", lambda m: noise.sway(m, 0.2))
        said = self.run_on(source, "--method", "gmr", output="auto.csv")
        self.assertNotIn("cleaned", said)
        self.run_on(source, "--method", "gmr", "--clean", "off", output="off.csv")
        auto, off = ((self.folder / f"{how}.csv").read_bytes() for how in ("auto", "off"))
        self.assertEqual(auto, off)

    def test_other_commands_have_no_such_option(self):
        result = self.run_tool("inspect", sample("wave"), "--clean", "off")
        self.assertEqual(result.returncode, 2, result.stderr)


if __name__ == "__main__":
    unittest.main()
