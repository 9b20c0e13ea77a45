"""The configuration of a run: the published one for LAFAN1, otherwise the robot's own."""

import json
import pathlib
import re
import shutil
import unittest

from tool import SOURCE, ToolTest, sample

PUBLISHED = "configs/lafan1_to_unitree_g1.json"
DERIVED = "robots/unitree_g1/ik.json"
# GAMES-105's names of LAFAN1's joints.
OTHER_NAMES = {"Hips": "RootJoint", "Spine": "pelvis_lowerback", "Spine1": "lowerback_torso",
               "LeftUpLeg": "lHip", "LeftLeg": "lKnee", "LeftFoot": "lAnkle",
               "LeftToe": "lToeJoint", "RightUpLeg": "rHip", "RightLeg": "rKnee", "RightFoot": "rAnkle",
               "RightToe": "rToeJoint", "LeftShoulder": "lTorso_Clavicle", "LeftArm": "lShoulder",
               "LeftForeArm": "lElbow", "LeftHand": "lWrist", "RightShoulder": "rTorso_Clavicle",
               "RightArm": "rShoulder", "RightForeArm": "rElbow", "RightHand": "rWrist"}


def other_skeleton():
    """The sample wave with other joint names."""
    return re.sub(r"(ROOT|JOINT) (\w+)",
                  lambda m: f"{m[1]} {OTHER_NAMES.get(m[2], m[2])}", sample("wave").read_text())


class ConfigurationChoice(ToolTest):
    def setUp(self):
        super().setUp()
        self.other = self.write("other.bvh", other_skeleton())

    def run_with(self, bvh, *arguments, output="out.csv", robot="unitree_g1"):
        """The bytes of the output, the configuration of its report and the summary."""
        result = self.retarget(*arguments, "--report", "report.json", bvh=bvh, output=output,
                               robot=robot)
        self.assert_done(result)
        motion = json.loads((self.folder / "report.json").read_text())["motions"][0]
        return (self.folder / output).read_bytes(), motion["mapping"], result.stderr

    def test_every_skeleton_takes_the_derived_one(self):
        for clip in (sample("wave"), self.other):
            found, configuration, summary = self.run_with(clip, "--sidecar")
            self.assertEqual(configuration, DERIVED)
            self.assertIn(DERIVED, summary)
            sidecar = json.loads((self.folder / "out.csv.json").read_text())
            files = {each["role"]: each["file"] for each in sidecar["inputs"]}
            self.assertEqual(files["mapping"], DERIVED)
            self.assertEqual(sidecar["options"]["ik-config"], "")
            self.assertEqual(sidecar["found"]["scale"], "limbs")
            self.assert_done(self.run_tool("verify", "out.csv.json"))
            self.assertEqual(self.run_with(clip, "--ik-config", "derived")[0], found)
            other, configuration, _ = self.run_with(clip, "--ik-config", "published")
            self.assertEqual(configuration, PUBLISHED)
            self.assertNotEqual(other, found)

    def test_custom_configuration_keeps_its_scale_for_lafan1(self):
        run = self.run_with(sample("wave"), "--ik-config", SOURCE / PUBLISHED, "--sidecar")
        sidecar = json.loads((self.folder / "out.csv.json").read_text())
        self.assertEqual(sidecar["found"]["scale"], "table")
        self.assertEqual(self.run_with(sample("wave"), "--ik-config", "published")[0], run[0])

    def test_the_published_method_keeps_the_published_one_for_lafan1(self):
        gmr = ("--method", "gmr")
        found, configuration, summary = self.run_with(sample("wave"), *gmr)
        self.assertEqual(configuration, PUBLISHED)
        self.assertNotIn("derived", summary)
        self.assertEqual(self.run_with(sample("wave"), *gmr, "--ik-config", "published")[0], found)
        other, configuration, _ = self.run_with(sample("wave"), *gmr, "--ik-config", "derived")
        self.assertEqual(configuration, DERIVED)
        self.assertNotEqual(other, found)
        found, configuration, summary = self.run_with(self.other, *gmr)
        self.assertEqual(configuration, DERIVED)
        self.assertIn("--ik-config published", summary)
        self.assertEqual(self.run_with(self.other, *gmr, "--ik-config", SOURCE / DERIVED)[0], found)

    def test_evaluate_tracks_the_same_bodies_as_a_run(self):
        self.run_with(self.other)
        for arguments, configuration in (((), DERIVED), (("--ik-config", "published"), PUBLISHED)):
            result = self.run_tool("evaluate", "out.csv", "--robot", "unitree_g1", "--bvh",
                                   self.other, "--json", "-", "--gate", "none", *arguments)
            self.assert_done(result)
            self.assertEqual(json.loads(result.stdout)["motions"][0]["mapping"], configuration)

    def test_in_a_batch_each_clip_has_its_own(self):
        self.write("in/other.bvh", self.other.read_bytes())
        self.write("in/wave.bvh", sample("wave").read_bytes())
        gmr = ("--method", "gmr")
        result = self.run_tool("batch", "in", "-o", "out", "--robot", "unitree_g1", *gmr)
        self.assert_done(result)
        lines = (self.folder / "out/manifest.jsonl").read_text().splitlines()
        found = {line["relative"]: line["mapping"] for line in map(json.loads, lines)}
        self.assertEqual(found, {"other.bvh": DERIVED, "wave.bvh": PUBLISHED})
        for name, clip in (("other", self.other), ("wave", sample("wave"))):
            self.assertEqual((self.folder / f"out/{name}.csv").read_bytes(),
                             self.run_with(clip, *gmr)[0], name)
        hashed = json.loads((self.folder / "out/options.json").read_text())[0]["files"]
        self.assertTrue(hashed["mapping"] and hashed["mapping_of_others"])
        both = self.run_tool("batch", "in", "-o", "both", "--robot", "unitree_g1,booster_t1",
                             "--ik-config", "derived")
        self.assert_done(both)

    def test_custom_robot_folder_keeps_its_configuration(self):
        folder = pathlib.Path(shutil.copytree(SOURCE / "robots/unitree_g1",
                                              self.folder / "mine/unitree_g1"))
        self.assertEqual(self.run_with(sample("wave"), robot=folder)[1], str(folder / "ik.json"))
        (folder / "ik.json").unlink()
        self.assertEqual(self.run_with(self.other, robot=folder)[1], PUBLISHED)

    def test_the_name_of_a_model_alone_selects_only_a_fitting_one(self):
        self.run_with(sample("wave"))
        model = self.folder / "mine/unitree_g1.xml"
        model.parent.mkdir()
        shutil.copy(SOURCE / "robots/unitree_g1/model.xml", model)
        evaluate = ("evaluate", "out.csv", "--robot-xml", model, "--bvh", sample("wave"), "--gate", "none")
        result = self.run_tool(*evaluate)
        self.assert_done(result)
        said = " ".join(result.stderr.split())
        self.assertIn("lafan1_to_unitree_g1.json, was chosen by the name of its model; --ik-config", said)
        result = self.run_tool(*evaluate, "--ik-config", SOURCE / PUBLISHED)
        self.assert_done(result)
        self.assertNotIn("by the name", result.stderr)
        model.write_text(model.read_text().replace("left_knee_link", "l_knee"))
        result = self.run_tool(*evaluate)
        self.assert_fails(result, 4, 'no retargeting configuration for the robot "unitree_g1"',
                          "the published one of that name does not fit", "left_knee_link", "--ik-config")

    def test_offsets_of_another_model_are_reported(self):
        # The forearms of the X2 point along z, those of the G1 along x; their bodies have the same names.
        words = ('"left_elbow_link" (LeftForeArm) by 94 degrees', '"right_elbow_link" (RightForeArm) by 94')
        for robot, is_own in (("agibot_x2", False), ("unitree_g1", True), ("unitree_h1_2", True)):
            options = ("--ik-config", SOURCE / PUBLISHED)
            _, _, said = self.run_with(sample("wave"), *options, robot=robot)
            live = self.run_tool("live", "--robot", robot, *options, "-o", "live.csv")
            self.assert_done(live)
            for text in (said, live.stderr):
                for word in words:
                    self.assertEqual(word not in " ".join(text.split()), is_own, (robot, text))

    def test_missing_files_are_errors(self):
        self.assert_fails(self.retarget("--ik-config", "published", robot="unitree_h1"), 4,
                          "no published retargeting configuration", "unitree_h1")

    def test_show_names_both(self):
        shown = self.run_tool("robots", "show", "unitree_g1")
        self.assertIn(PUBLISHED, shown.stdout)
        self.assertIn(DERIVED, shown.stdout)
        self.assert_done(self.run_tool("robots", "check", "unitree_g1"))


if __name__ == "__main__":
    unittest.main()
