"""Motions of robots as sources: to the same robot, to others, in all formats, in batches."""

import json
import math
import os
import pathlib
import shutil
import unittest

from motion_formats import FORMATS
from tool import SHARED, SOURCE, ToolTest, needs_shared, read_rows, sample

DEGREE = math.pi / 180


# Source and robot, and the maximum deviation of limbs from the source's, degrees. If hips, knees
# and elbows are not collinear, they form separate lines.
PAIRS = {
    ("unitree_g1", "booster_t1_29dof"): 4.0,
    ("booster_t1_29dof", "unitree_h1"): 12.0,
    ("fourier_n1", "stanford_toddy"): 12.0,
    ("unitree_h1", "unitree_g1"): 12.0,
}


def joints_rms(found, expected):
    """Returns the RMS joint difference over all frames, degrees."""
    squares = [(a - b)**2 for row, wanted in zip(found, expected)
               for a, b in zip(row[7:], wanted[7:])]
    return math.sqrt(sum(squares) / len(squares)) / DEGREE


class RobotToRobot(ToolTest):
    def make(self, name="walk", robot="unitree_g1", output="made.csv", *options):
        """Returns the robot motion of a sample."""
        self.assert_done(self.retarget(*options, bvh=sample(name), robot=robot, output=output))
        return self.folder / output

    def convert(self, motion, source, robot, output, *options):
        result = self.run_tool("--motion", motion, "--from-robot", source, "--robot", robot, "-o",
                               output, *options)
        self.assert_done(result)
        return result

    def limb_angle(self, name):
        return self.report(name)["limb_angle_deg"][0]

    def y_up(self, rows):
        """Converts a motion to Y up: (x, y, z) becomes (x, z, -y)."""
        half = math.sqrt(0.5)
        turned = []
        for row in rows:
            x, y, z, qx, qy, qz, qw = row[:7]
            # A quarter turn about x maps z to y: (-half, 0, 0, half) times q.
            quaternion = [half * (qx - qw), half * (qy + qz), half * (qz - qy), half * (qw + qx)]
            turned.append([x, z, -y, *quaternion, *row[7:]])
        return turned

    def test_a_file_with_another_axis_up_is_turned_with_a_warning(self):
        self.make("walk")
        rows = self.rows("made.csv")
        text = "\n".join(",".join(map(repr, row)) for row in self.y_up(rows))
        self.write("turned.csv", text + "\n")
        upright = self.convert("made.csv", "g1", "g1", "upright.csv")
        self.assertNotIn("--up", upright.stderr)
        found = self.convert("turned.csv", "g1", "g1", "found.csv")
        self.assertRegex(found.stderr, r"warning: .*stands on a floor.*using [+]y as the up axis; override it with --up")
        given = self.convert("turned.csv", "g1", "g1", "given.csv", "--up", "y")
        self.assertNotIn("warning", given.stderr)
        for name in ("found.csv", "given.csv"):
            for row, wanted in zip(self.rows(name), self.rows("upright.csv")):
                self.assertLess(max(abs(a - b) for a, b in zip(row[2:3] + row[7:],
                                                               wanted[2:3] + wanted[7:])), 1e-3)
        # An explicit axis overrides the check, with a warning.
        converted = self.convert("turned.csv", "g1", "g1", "converted.csv", "--up", "z")
        self.assertNotIn("using +y", converted.stderr)
        self.assertIn("without --up, retarget finds +y as the up axis, not +z", converted.stderr)

    def test_same_robot_reproduces_the_motion(self):
        for name in ("walk", "squat", "wave", "turn_in_place"):
            self.make(name)
            result = self.convert("made.csv", "g1", "g1", "back.csv")
            made, back = self.rows("made.csv"), self.rows("back.csv")
            self.assertEqual(len(made), len(back))
            self.assertLess(joints_rms(back, made), 0.5, name)
            self.assertIn("the robot unitree_g1 as a human", result.stderr)

    def test_pairs_of_robots(self):
        for source, robot in PAIRS:
            with self.subTest(source=source, robot=robot):
                self.make(robot=source)
                self.convert("made.csv", source, robot, "other.csv", "--report", "other.json")
                self.assertEqual(len(self.rows("made.csv")), len(self.rows("other.csv")))
                self.assertLess(self.limb_angle("other.json"), PAIRS[source, robot])

    def test_every_format_is_read(self):
        names = [name for name in FORMATS if name != "glb"]
        # PBHC's files have fewer joints, and tracking files their own rate.
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:60", "--npz-fps", 30,
                                       "--format", ",".join(names), bvh=sample("walk"),
                                       output="walk"))
        self.convert("walk.csv", "g1", "t1", "of_csv.csv", "--method", "gmr")
        expected = self.rows("of_csv.csv")
        for name in names:
            with self.subTest(format=name):
                self.convert(FORMATS[name].replace("out", "walk"), "g1", "t1", "of.csv", "--method",
                             "gmr", "--source-fps", 30)
                found = self.rows("of.csv")
                self.assertLessEqual(abs(len(found) - len(expected)), 2)
                if name != "pkl-pbhc":
                    frames = min(len(found), len(expected))
                    self.assertLess(joints_rms(found[:frames], expected[:frames]), 0.2)

    def test_other_rates(self):
        for fps in (24, 120):
            self.make("walk", "unitree_g1", "made.csv", "--fps", fps, "--sidecar")
            # The sidecar next to it states the rate.
            self.convert("made.csv", "g1", "g1", "back.csv", "--fps", "source")
            made, back = self.rows("made.csv"), self.rows("back.csv")
            self.assertEqual(len(made), len(back))
            self.assertLess(joints_rms(back, made), 1.0, fps)
            os.remove(self.folder / "made.csv.json")
            result = self.convert("made.csv", "g1", "g1", "slow.csv", "--fps", "source",
                                  "--frames", "0:30")
            self.assertIn("states no rate", result.stderr)

    def test_mirror_and_parts(self):
        self.make()
        self.convert("made.csv", "g1", "t1", "left.csv", "--method", "gmr", "--frames", "0:20")
        self.convert("made.csv", "g1", "t1", "right.csv", "--method", "gmr", "--frames", "0:20",
                     "--mirror")
        self.assertEqual(len(self.rows("left.csv")), 20)
        self.assertNotEqual((self.folder / "left.csv").read_text(),
                            (self.folder / "right.csv").read_text())

    def test_sidecar_and_verify(self):
        self.make("wave", "unitree_g1", "made.csv", "--method", "gmr")
        self.convert("made.csv", "g1", "h1", "other.csv", "--method", "gmr", "--sidecar")
        sidecar = json.loads((self.folder / "other.csv.json").read_text())
        self.assertEqual(sidecar["options"]["from-robot"], "g1")
        roles = {each["role"]: each["file"] for each in sidecar["inputs"]}
        self.assertEqual(roles["source_model"], "robots/unitree_g1/model.xml")
        self.assertEqual(roles["source_profile"], "robots/unitree_g1/robot.json")
        self.assertEqual(roles["source_mapping"], "robots/unitree_g1/ik.json")
        self.assertIn("unitree_g1", sidecar["found"]["skeleton"])
        self.assert_done(self.run_tool("verify", "other.csv.json"))

    def test_evaluate_and_view_use_the_source(self):
        self.make("walk")
        self.convert("made.csv", "g1", "t1", "other.csv", "--report", "other.json")
        result = self.run_tool("evaluate", "other.csv", "--robot", "t1", "--bvh", "made.csv",
                               "--from-robot", "g1", "--json", "again.json")
        self.assertIn(result.returncode, (0, 1), result.stderr)
        made, again = self.report("other.json"), self.report("again.json")
        self.assertEqual(made["limb_angle_deg"], again["limb_angle_deg"])
        self.assertEqual(made["tracking"], again["tracking"])
        self.assert_done(self.run_tool("view", "other.csv", "--robot", "t1", "--bvh", "made.csv",
                                       "--from-robot", "g1", "-o", "page.html"))
        self.assert_done(self.run_tool("inspect", "made.csv", "--from-robot", "g1"))
        self.assert_done(self.run_tool("edit", "mirror", "made.csv", "--from-robot", "g1", "-o",
                                       "mirrored.bvh"))

    def test_batch_of_all_formats(self):
        folder = self.folder / "motions" / "sub"
        folder.mkdir(parents=True)
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:40", "--format",
                                       "csv,npz-mjlab,pkl-gmr,csv-sonic", bvh=sample("walk"),
                                       output="motions/sub/walk"))
        (folder / "walk.csv").rename(folder / "plain.csv")
        shutil.copy(sample("wave"), folder / "human.bvh")
        arguments = ("batch", "motions", "--from-robot", "g1", "--robot", "t1", "-o", "out",
                     "--method", "gmr")
        self.assert_done(self.run_tool(*arguments))
        lines = [json.loads(line) for line in
                 (self.folder / "out" / "manifest.jsonl").read_text().splitlines()]
        self.assertEqual(sorted(pathlib.Path(line["relative"]).name for line in lines),
                         sorted(path.name for path in folder.iterdir() if path.suffix != ".bvh"))
        self.assertTrue((self.folder / "out" / "sub" / "plain.csv").is_file())
        options = json.loads((self.folder / "out" / "options.json").read_text())[0]
        self.assertEqual(options["source_robot"], "unitree_g1")
        # Done and unchanged, including the folder.
        again = self.run_tool(*arguments, "--resume")
        self.assert_done(again)
        self.assertIn("4 of 4 are done and unchanged", again.stderr)

    def test_own_robot_folder(self):
        """A robot added by the user also works as a source."""
        self.assert_done(self.run_tool("robots", "add", "mine", "--model",
                                       SOURCE / "robots" / "fourier_n1" / "model.xml"))
        self.make("walk", "./mine", "made.csv", "--method", "gmr")
        self.convert("made.csv", "./mine", "g1", "other.csv", "--method", "gmr")

    def test_wrong_uses(self):
        self.make("wave", "unitree_g1", "made.csv", "--method", "gmr", "--frames", "0:20")
        run = self.run_tool
        self.assert_fails(run("made.csv", "t1", "-o", "x.csv"), 3, "--from-robot NAME")
        self.assert_fails(run("made.csv", "t1", "-o", "x.csv", "--from-robot", "h1"), 3,
                          "joints", "unitree_h1")
        self.assert_fails(run("made.csv", "t1", "-o", "x.csv", "--from-robot", "unitree_g2"), 4,
                          "unitree_g1")
        self.assert_fails(run(sample("wave"), "t1", "-o", "x.csv", "--from-robot", "g1"), 3,
                          "omit --from-robot")
        self.assert_fails(run("made.csv", "t1", "-o", "x.csv", "--from-robot", "g1", "--unit",
                              "cm"), 2, "--unit", "--from-robot")
        self.assert_fails(run("made.csv", "t1", "-o", "x.csv", "--from-robot", "g1", "--lenient"),
                          2, "--lenient")
        self.assert_fails(run(sample("wave"), "t1", "-o", "x.csv", "--source-quat", "wxyz"), 2,
                          "--source-quat", "--from-robot")
        self.assert_fails(run("batch", ".", "--robot", "t1", "-o", "out"), 3, "--from-robot")
        self.assertEqual(self.files(), ["made.csv"])


@needs_shared
class PublishedMotions(ToolTest):
    """Published motions of the G1 and their source clips."""

    PART = ("--start", "2", "--end", "8")

    def setUp(self):
        super().setUp()
        data = SHARED / "data"
        self.motions = data / "unitree_g1_csv"
        self.clips = data / "lafan1"
        self.motion = self.motions / "dance1_subject2.csv"

    def limb_angle(self, source, robot, *options):
        self.assert_done(self.run_tool(source, robot, "-o", "made.csv", "--report", "made.json",
                                       *self.PART, *options))
        report = json.loads((self.folder / "made.json").read_text())
        return report["motions"][0]["limb_angle_deg"][0]

    def test_g1_reproduces_itself(self):
        """The fit tracks the motion itself; its other terms repair the motion's faults."""
        self.limb_angle(self.motion, "g1", "--from-robot", "g1", "--without",
                        "contact,floor,self-collision,foot-height,smoothness,speed")
        back = read_rows((self.folder / "made.csv").read_text())
        lines = self.motion.read_text().splitlines()
        self.assertLess(joints_rms(back, read_rows("\n".join(lines[60:60 + len(back)]))), 0.1)

    def test_faults_of_a_motion_are_repaired_nearby(self):
        """Published motions overlap themselves and their feet slip: after the repair they pass all gates."""
        result = self.run_tool(self.motion, "g1", "--from-robot", "g1", "-o", "made.csv", "--gate",
                               "default", *self.PART)
        self.assert_done(result)
        back = read_rows((self.folder / "made.csv").read_text())
        lines = self.motion.read_text().splitlines()
        self.assertLess(joints_rms(back, read_rows("\n".join(lines[60:60 + len(back)]))), 2.5)

    def test_another_robot_moves_as_from_the_clip(self):
        for name in ("dance1_subject2", "walk4_subject1", "fallAndGetUp2_subject2"):
            with self.subTest(clip=name):
                of_clip = self.limb_angle(self.clips / f"{name}.bvh", "booster_t1_29dof")
                of_robot = self.limb_angle(self.motions / f"{name}.csv", "booster_t1_29dof",
                                           "--from-robot", "g1")
                self.assertLess(of_robot, of_clip + 1.0)


if __name__ == "__main__":
    unittest.main()
