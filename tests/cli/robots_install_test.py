"""`retarget robots install`, and robots that are known but not installed."""

import json
import shutil
import unittest
import zipfile

from tool import SOURCE, ToolTest, sample

K1 = SOURCE / "robots/unverified/booster_k1/model.xml"


class RobotsThatAreNotInstalled(ToolTest):
    """A data folder like that of packages: some known robots are not installed."""

    def setUp(self):
        super().setUp()
        self.data = self.folder / "share"
        shutil.copytree(SOURCE / "robots", self.data / "robots")
        shutil.copytree(SOURCE / "configs", self.data / "configs")
        shutil.rmtree(self.data / "robots/unverified")
        shutil.rmtree(self.data / "robots/booster_t1")

    def run_here(self, *arguments, **variables):
        return self.run_tool(*arguments, "--data-dir", self.data, env=self.tool_environment(**variables))

    def move(self, robot, *arguments):
        return self.run_here(sample("wave"), robot, "--frames", ":30", "-o", "x.csv", *arguments)

    def test_a_full_name_is_not_completed_to_another_robot(self):
        for robot in ("booster_t1", "Booster-T1", "t1"):
            result = self.move(robot)
            self.assert_fails(result, 4, "the robot booster_t1 is not installed",
                              "retarget robots install booster_t1 --source SOURCE")
        self.assert_fails(self.move("booster_k1"), 4, "its maker states no licence")
        # The robot may precede the motion.
        result = self.run_here("booster_t1", sample("wave"), "-o", "x.csv")
        self.assert_fails(result, 4, "the robot booster_t1 is not installed")
        self.assert_fails(self.move("booster"), 4, "booster_k1 (not installed)", "booster_t1_29dof")
        self.assertFalse((self.folder / "x.csv").exists())

    def test_a_completed_name_is_shown(self):
        self.assertIn('robot    "g1" is unitree_g1\n', self.move("g1").stderr)
        self.assertNotIn(" is unitree_g1", self.move("unitree_g1").stderr)

    def test_the_list_names_them(self):
        listed = json.loads(self.run_here("robots", "list", "--json").stdout)
        names = sorted(p.parent.name for p in SOURCE.glob("robots/**/model.xml"))
        self.assertEqual([robot["name"] for robot in listed], names)
        left_out = {robot["name"] for robot in listed if not robot["installed"]}
        unverified = {p.name for p in (SOURCE / "robots/unverified").iterdir()}
        self.assertEqual(left_out, unverified | {"booster_t1"})
        lines = self.run_here("robots", "list").stdout.splitlines()
        self.assertEqual({line.split()[0] for line in lines if line.endswith("(not installed)")}, left_out)

    def assert_moves_as_in_the_source(self, robot, *arguments):
        self.assert_done(self.move(robot, *arguments))
        found = (self.folder / "x.csv").read_bytes()
        self.assert_done(self.run_tool(sample("wave"), robot, "--frames", ":30", "-o", "x.csv", *arguments))
        self.assertEqual(found, (self.folder / "x.csv").read_bytes())

    def test_one_is_installed_from_the_source_tree(self):
        installed = self.run_here("robots", "install", "booster_k1", "booster_t1", "--source", SOURCE)
        self.assert_done(installed)
        self.assertIn("booster_k1: the maker states none", installed.stderr)
        self.assertNotIn("booster_t1: its maker", installed.stderr)
        own = self.folder / "data home/retarget/robots"
        for folder, source in ((own / "booster_t1", "robots/booster_t1"),
                               (own / "unverified/booster_k1", "robots/unverified/booster_k1")):
            for file in (SOURCE / source).iterdir():
                self.assertEqual((folder / file.name).read_bytes(), file.read_bytes())
        self.assert_moves_as_in_the_source("booster_k1")
        # With the published configuration, like a robot of the data folder.
        self.assert_moves_as_in_the_source("t1", "--method", "gmr")
        again = self.run_here("robots", "install", "booster_k1", "--source", SOURCE)
        self.assert_fails(again, 2, "already exists", "--force")
        self.assert_done(self.run_here("robots", "install", "booster_k1", "--source", SOURCE, "--force"))

    def test_all_are_installed_from_an_archive(self):
        with zipfile.ZipFile(self.folder / "robots.zip", "w", zipfile.ZIP_DEFLATED) as archive:
            for file in sorted((SOURCE / "robots/unverified").glob("*/*")):
                archive.write(file, f"retarget-1/{file.relative_to(SOURCE)}")
            archive.writestr("retarget-1/README.md", "text")
        self.assert_done(self.run_here("robots", "install", "--source", "robots.zip"))
        own = self.folder / "data home/retarget/robots/unverified"
        self.assertEqual({p.name for p in own.iterdir()},
                         {p.name for p in (SOURCE / "robots/unverified").iterdir()})
        self.assert_moves_as_in_the_source("kuavo")
        done = self.run_here("robots", "install", "--source", "robots.zip")
        self.assert_done(done)
        self.assertIn("are installed", done.stderr)
        # Into a chosen folder.
        (self.folder / "mine").mkdir()
        self.assert_done(self.run_here("robots", "install", "limx_oli", "--source", "robots.zip", "-o", "mine"))
        self.assertTrue((self.folder / "mine/limx_oli/model.xml").is_file())

    def test_failed_installs_leave_no_files(self):
        own = self.folder / "data home"
        self.assert_fails(self.run_here("robots", "install", "booster_k2", "--source", SOURCE), 2,
                          'did you mean "booster_k1"?')
        self.write("text.txt", "text")
        self.assert_fails(self.run_here("robots", "install", "--source", "text.txt"), 2, "neither a folder nor a ZIP")
        self.write("empty/readme", "")
        self.assert_fails(self.run_here("robots", "install", "--source", "empty"), 2, "no robots in it")
        self.write("bad/robots/bad/model.xml", "<mujoco>")
        self.assert_fails(self.run_here("robots", "install", "--source", "bad"), 4, "model.xml")
        self.write("bad/robots/bad/model.xml", K1.read_bytes())
        self.write("bad/robots/bad/robot.json", K1.with_name("robot.json").read_bytes())
        self.assert_fails(self.run_here("robots", "install", "--source", "bad"), 4, 'names the robot "booster_k1"')
        with zipfile.ZipFile(self.folder / "evil.zip", "w") as archive:
            archive.writestr("robots/../model.xml", K1.read_bytes())
            archive.writestr("robots/x/../../y/model.xml", K1.read_bytes())
        self.assert_fails(self.run_here("robots", "install", "--source", "evil.zip"), 2)
        self.assertFalse([file for file in own.rglob("*") if file.is_file()])


if __name__ == "__main__":
    unittest.main()
