"""Robots with a fixed base: upper bodies on a stand."""

import json
import unittest

from tool import ToolTest, read_rows, sample


class FixedBase(ToolTest):
    def write_torso(self, place="pos='0 0 0.8'", column=""):
        """An upper body on a stand, which may have a column."""
        limb = ("<body name='{0}_upper' pos='0 {1} 0.4'><joint name='{0}_pitch' axis='0 1 0'/>"
                "<joint name='{0}_roll' axis='1 0 0'/><joint name='{0}_yaw' axis='0 0 1'/>"
                "<body name='{0}_fore' pos='0 0 -0.25'><joint name='{0}_elbow' axis='0 1 0' range='-2.5 0.1'/>"
                "<body name='{0}_hand' pos='0 0 -0.25'><joint name='{0}_wrist' axis='0 0 1'/>"
                "<geom size='0.03' mass='0.3'/></body><geom size='0.03' mass='1'/></body><geom size='0.04' mass='1'/></body>")
        self.write("torso.xml", "<mujoco><compiler angle='radian'/><default><joint range='-2.8 2.8'/></default><worldbody>"
                   f"<body name='stand' {place}><geom size='0.1' mass='9'/>{column}<body name='torso'>"
                   "<joint name='waist' axis='0 0 1' range='-1 1'/><geom size='0.1' mass='9'/>" +
                   limb.format("left", 0.2) + limb.format("right", -0.2) + "</body></body></worldbody></mujoco>")

    def test_an_upper_body_with_a_fixed_base(self):
        self.write_torso()
        refused = self.run_tool("robots", "add", "torso", "--model", "torso.xml")
        self.assert_fails(refused, 4, "--base fixed")
        self.assert_done(self.run_tool("robots", "add", "torso", "--model", "torso.xml", "--base", "fixed"))
        checked = self.run_tool("robots", "check", "torso")
        self.assert_done(checked)
        self.assertIn("0 errors", checked.stdout)
        bare = ("--robot-xml", "torso.xml", "--base", "fixed", "--ik-config", "torso/ik.json")
        for robot in (("--robot", "torso"), bare):
            for method in ("fit", "gmr"):
                run = self.run_tool("--bvh", sample("walk"), "--frames", ":60", *robot, "--method", method,
                                    "--report", "r.json", "-o", "x.csv")
                self.assert_done(run)
                rows = read_rows((self.folder / "x.csv").read_text())
                self.assertEqual({tuple(row[:7]) for row in rows}, {(0, 0, 0.8, 0, 0, 0, 1)})
                motion = json.loads((self.folder / "r.json").read_text())["motions"][0]
                self.assertFalse([name for name in motion if name.startswith(("float", "stance", "body_pen"))])
                self.assertLess(motion["limb_angle_deg"][0], 8)
        # In a robot with legs and a fixed base, the path of the feet has no effect.
        for method in ("fit", "gmr"):
            held = self.run_tool("--bvh", sample("walk"), "--frames", ":60", "--robot", "g1", "--base", "fixed",
                                 "--method", method, "-o", "-")
            self.assert_done(held)
            self.assertEqual({tuple(row[:7]) for row in read_rows(held.stdout)}, {(0, 0, 0.793, 0, 0, 0, 1)})

    def test_motions_of_a_fixed_base_can_be_read_back(self):
        """The pose of the base determines the order of its quaternion; its height does not determine the unit."""
        for place in ("pos='0 0 0.8'", "pos='0 0 0'", "pos='0.3 0.1 9' quat='0.8 0 0 0.6'",
                      "pos='0 0 1' quat='0.995 0 0.0998 0'", "pos='0 0 0.8' quat='0 0 0 1'"):
            with self.subTest(place=place):
                self.write_torso(place, "<geom type='capsule' fromto='0 0 -0.1 0 0 -0.9' size='0.05' mass='1'/>")
                self.assert_done(self.run_tool("robots", "add", "torso", "--model", "torso.xml", "--base", "fixed",
                                               "--force"))
                made = self.run_tool(sample("wave"), "torso", "-o", "x.csv")
                self.assert_done(made)
                for order in ("xyzw", "wxyz"):
                    self.assert_done(self.run_tool("convert", "x.csv", "y.csv", "--robot", "torso", "--csv-quat",
                                                   order, "--source-quat", "xyzw"))
                    read = self.run_tool("convert", "y.csv", "z.csv", "--robot", "torso")
                    self.assert_done(read)
                    self.assertIn(f"quaternion {order}", read.stderr)
                    self.assertEqual((self.folder / "z.csv").read_bytes(), (self.folder / "x.csv").read_bytes())
                for command in (("evaluate", "y.csv", "--bvh", sample("wave")),
                                ("view", "y.csv", "-o", "x.html")):
                    self.assert_done(self.run_tool(*command, "--robot", "torso"))


if __name__ == "__main__":
    unittest.main()
