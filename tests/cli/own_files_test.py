"""Files of this tool are read correctly by header, sidecar or the robot's data."""

import json
import shutil
import unittest

from motion_formats import FormatsTest
from tool import SOURCE, sample

ROBOTS = sorted(file.parent.name for file in [*SOURCE.glob("robots/*/robot.json"),
                                              *SOURCE.glob("robots/unverified/*/robot.json")])
# An unusual user robot: 30 cm, joints without ranges (artificial).
FREE_ARM = """<mujoco><compiler angle="radian"/><worldbody><body name="base" pos="0 0 0.3">
  <freejoint/><geom size="0.05" mass="1"/>
  <body name="left_foot" pos="0 0.05 -0.3"><joint name="left" axis="0 0 1"/>
    <geom size="0.02" mass="1"/></body>
  <body name="right_foot" pos="0 -0.05 -0.3"><joint name="right" axis="0 1 0"/>
    <geom size="0.02" mass="1"/></body>
</body></worldbody></mujoco>"""


class OwnFiles(FormatsTest):
    # Layouts that a file identifies by itself.
    TOLD = {
        "plain": (),
        "header": ("--csv-header",),
        "turned": ("--csv-quat", "wxyz", "--csv-frame-column", "--csv-delimiter", "space"),
        "all": ("--csv-header", "--csv-quat", "wxyz", "--csv-frame-column", "--csv-degrees",
                "--csv-centimetres", "--csv-delimiter", "tab"),
    }
    # Layouts that need a sidecar or an option.
    UNTOLD = ("--csv-degrees", "--csv-centimetres", "--csv-quat", "wxyz")

    def own_rows(self, robot, clip):
        self.assert_done(self.retarget("--precision", "9", bvh=sample(clip), robot=robot,
                                       output="own.csv"))
        return self.rows("own.csv")

    def test_of_every_robot_without_a_sidecar(self):
        self.assertGreater(len(ROBOTS), 8)
        for robot in ROBOTS:
            for clip in ("wave", "get_up"):
                rows = self.own_rows(robot, clip)
                given = ("--source-quat", "xyzw")
                for name, how in self.TOLD.items():
                    if clip == "get_up" and name != "plain":
                        continue
                    with self.subTest(f"{robot}, {clip}, {name}"):
                        self.assert_done(self.convert("own.csv", "way.csv", "--precision", "9",
                                                      *given, *how, robot=robot))
                        result = self.convert("way.csv", "back.csv", "--precision", "9",
                                              robot=robot)
                        self.assert_done(result)
                        self.assertNotIn("warning", result.stderr)
                        self.assert_same(self.rows("back.csv"), rows, 1e-7)
                if clip == "get_up":
                    continue
                with self.subTest(f"{robot}, {clip}, untold"):
                    self.assert_done(self.convert("own.csv", "way.csv", "--precision", "9", *given,
                                                  *self.UNTOLD, robot=robot))
                    self.assert_fails(self.convert("way.csv", "x.csv", robot=robot), 3,
                                      "--source-angles deg")
                    # Read as metres it is rejected, or causes a warning where it may be the top of
                    # a wall.
                    result = self.convert("way.csv", "x.csv", "--source-angles", "deg",
                                          robot=robot)
                    self.assertIn(result.returncode, (0, 3))
                    self.assertIn("--source-unit", result.stderr)
                    self.assert_done(self.convert(
                        "way.csv", "back.csv", "--precision", "9", "--source-angles", "deg",
                        "--source-unit", "cm", "--source-quat", "wxyz", robot=robot))
                    self.assert_same(self.rows("back.csv"), rows, 1e-7)

    def test_headers_name_units_that_are_not_the_usual_ones(self):
        self.assert_done(self.retarget(*self.TOLD["all"][:-2], output="out.csv"))
        names = (self.folder / "out.csv").read_text().split("\n", 1)[0].split(",")
        self.assertEqual(names[:5], ["Frame", "root_x(cm)", "root_y(cm)", "root_z(cm)", "root_qw"])
        self.assertEqual(names[8], "left_hip_pitch_joint(deg)")
        self.assert_done(self.retarget("--csv-header", output="usual.csv"))
        self.assertNotIn("(", (self.folder / "usual.csv").read_text())

    def test_joints_without_a_range_may_turn_on(self):
        self.write("model.xml", FREE_ARM)
        rows = [[0, 0, 0.32, 0, 0, 0.5 ** 0.5, 0.5 ** 0.5, 0.1 * frame, -0.05 * frame]
                for frame in range(100)]
        self.write("own.csv", "".join(",".join(f"{v:.6f}" for v in row) + "\n" for row in rows))
        model = ("--robot-xml", "model.xml", "--source-quat", "xyzw")
        self.assert_done(self.run_tool("convert", "own.csv", "back.csv", *model))
        self.assert_same(self.rows("back.csv"), rows, 2e-6)
        self.assert_done(self.run_tool("convert", "own.csv", "degrees.csv", *model,
                                       "--csv-degrees"))
        self.assert_fails(self.run_tool("convert", "degrees.csv", "x.csv", *model), 3,
                          "--source-angles")


class Sidecars(FormatsTest):
    def setUp(self):
        super().setUp()
        common = ("--frames", "0:60", "--fps", "60", "--precision", "9", "--dof", "23")
        self.assert_done(self.retarget(*common, output="plain.csv"))
        self.assert_done(self.retarget(*common, *OwnFiles.UNTOLD, "--sidecar", output="odd.csv"))

    def test_sidecars_supply_missing_properties(self):
        said = self.converted("odd.csv", "back.csv", "--precision", "9", "--dof", "23")
        self.assertIn("at 60 fps", said)
        self.assertIn("odd.csv.json records", said)
        self.assertNotIn("the file states no rate", said)
        self.assert_same(self.rows("back.csv"), self.rows("plain.csv"), 1e-8)
        for command in ("evaluate", "view"):
            result = self.run_tool(command, "odd.csv", "--robot", "unitree_g1",
                                   *(("-o", "v.html") if command == "view" else
                                     ("--gate", "none")))
            self.assert_done(result)
            self.assertIn("odd.csv.json records", result.stderr)
        self.assert_done(self.run_tool("compare", "back.csv", "odd.csv", "--robot", "unitree_g1",
                                       "--source-dof", "23", "--tolerance", "1e-6"))

    def test_sidecars_of_renamed_files_apply(self):
        for ending in ("", ".json"):
            (self.folder / f"odd.csv{ending}").rename(self.folder / f"new.csv{ending}")
        self.assertIn("new.csv.json records", self.converted("new.csv", "back.csv", "--precision", "9", "--dof", "23"))
        self.assert_same(self.rows("back.csv"), self.rows("plain.csv"), 1e-8)

    def test_sidecars_of_other_content_are_ignored(self):
        with open(self.folder / "odd.csv", "a") as file:
            file.write("\n")
        options = ("--source-dof", "23", "--source-angles", "deg", "--source-unit", "cm")
        self.assert_fails(self.convert("odd.csv", "x.csv", *options[:2]), 3, "--source-angles")
        said = self.converted("odd.csv", "back.csv", *options)
        self.assertIn("another version", said)
        self.assertIn("30 fps; the file states no rate", said)

    def test_other_files_are_not_changed(self):
        shutil.copy(self.folder / "odd.csv.json", self.folder / "plain.csv.json")
        self.assertNotIn("plain.csv.json", self.converted("plain.csv", "a.csv", "--source-dof", 23))
        for text in ("", "[]", "{", json.dumps({"output": 3}), "\xff"):
            self.write("plain.csv.json", text)
            said = self.converted("plain.csv", "b.csv", "--source-dof", 23)
            self.assertNotIn("plain.csv.json", said)
        self.assertEqual((self.folder / "a.csv").read_bytes(), (self.folder / "b.csv").read_bytes())

    def test_the_recorded_robot_is_required(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:20", "--sidecar",
                                       robot="engineai_pm01", output="pm.csv"))
        reads = (("convert", "pm.csv", "x.csv", "--robot"), ("evaluate", "pm.csv", "--robot"),
                 ("pm.csv", "unitree_g1", "-o", "x.csv", "--from-robot"))
        for words in reads:
            with self.subTest(words[0]):
                self.assert_fails(self.run_tool(*words, "unitree_r1"), 3, "engineai_pm01",
                                  "pm.csv.json", "unitree_r1")
                self.assertFalse((self.folder / "x.csv").exists())
        # A short name, and a folder with any name.
        shutil.copytree(SOURCE / "robots" / "engineai_pm01", self.folder / "mine")
        for robot in ("pm01", "mine", "./mine"):
            with self.subTest(robot):
                self.assert_done(self.run_tool(*reads[0], robot))
                self.assert_done(self.run_tool(*reads[2], robot, "--method", "gmr"))
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:20", "--sidecar",
                                       robot="./mine", output="pm.csv"))
        self.assert_done(self.run_tool(*reads[0], "engineai_pm01"))
        # Other formats state no robot either.
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:20", "--sidecar",
                                       "--format", "pkl-gmr", robot="engineai_pm01", output="pm.pkl"))
        self.assert_fails(self.run_tool("convert", "pm.pkl", "y.csv", "--robot", "unitree_r1"), 3,
                          "pm.pkl.json")
        (self.folder / "pm.csv.json").unlink()
        self.assert_done(self.run_tool(*reads[0], "unitree_r1"))

    def test_options_take_precedence(self):
        said = self.converted("odd.csv", "back.csv", "--source-fps", "50", "--source-unit", "m")
        self.assertIn("at 50 fps", said)
        self.assertGreater(self.rows("back.csv")[0][2], 50.0)


if __name__ == "__main__":
    unittest.main()
