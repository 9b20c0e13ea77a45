"""`retarget robots`: the list, unusual robots, new robots."""

import json
import re
import unittest

from pages import data_of
from tool import SOURCE, ToolTest, read_rows, sample, short_clip, unwrapped

K1 = SOURCE / "robots/unverified/booster_k1/model.xml"


class Robots(ToolTest):
    def output_of(self, *arguments):
        result = self.run_tool("robots", *arguments)
        self.assert_done(result)
        return result.stdout

    def test_list_and_show(self):
        names = sorted(p.parent.name for p in SOURCE.glob("robots/**/model.xml"))
        listed = json.loads(self.output_of("list", "--json"))
        self.assertEqual([robot["name"] for robot in listed], names)
        self.assertTrue(all(robot["mapping"] for robot in listed))
        lines = self.output_of("list").splitlines()
        self.assertEqual(len(lines), len(names))
        for robot, line in zip(listed, lines):
            unverified = (SOURCE / "robots/unverified" / robot["name"]).is_dir()
            self.assertEqual(robot["licence_stated"], not unverified)
            self.assertEqual(line.endswith(" (no stated licence)"), unverified)
            self.assertEqual(robot["licence"].startswith("none stated"), unverified)
        shown = json.loads(self.output_of("show", "unitree_g1", "--json"))
        self.assertEqual(len(shown["joints"]), 29)
        self.assertEqual(shown["joints"][0]["name"], "left_hip_pitch_joint")
        self.assertEqual(shown["joints"][0]["limits"]["official"], [-2.5307, 2.8798])
        self.assertEqual(shown["joints"][0]["speed_limit"], 32)
        self.assertAlmostEqual(shown["sole_height_m"], 0.79, delta=0.02)
        self.assertAlmostEqual(shown["height_m"], 1.3, delta=0.1)
        self.assertEqual((shown["revision"], shown["revision_date"]), ("rev 1.0, adb48c7", None))
        dated = {robot["name"]: (robot["revision"], robot["revision_date"]) for robot in listed}
        self.assertEqual(dated["hightorque_pi_plus"], ("c05257c", "2025-11-03"))
        self.assertEqual(dated["kuavo_s45"], (None, None))
        self.assertIn("revision c05257c, date 2025-11-03", self.output_of("show", "pi_plus"))
        text = self.output_of("show", "unitree_g1")
        self.assertIn("revision rev 1.0, adb48c7, date not recorded", text)
        self.assertIn("left_hip_pitch_joint", text)
        self.assertIn("LeftForeArm", text)

    def test_a_new_robot_runs_at_once(self):
        self.write("mine.xml", K1.read_bytes())
        result = self.run_tool("robots", "add", "mine", "--model", "mine.xml")
        self.assert_done(result)
        self.assertEqual(self.files(), ["mine.xml", "mine/decisions.md", "mine/ik.json",
                                        "mine/model.xml", "mine/robot.json"])
        self.assertIn("0 errors", self.output_of("check", "mine"))
        rows = self.retarget("--frames", ":30", robot="mine", bvh=sample("walk"), output="-")
        self.assert_done(rows)
        self.assertEqual(len(read_rows(rows.stdout)[0]), 7 + 22)
        self.assert_fails(self.run_tool("robots", "add", "mine", "--model", "mine.xml"), 2,
                          "--force")

    def test_bodies_that_overlap_by_the_model_itself(self):
        """They are named wherever the model is used, and in the new robot's list."""
        thick = '<geom type="box" pos="0 0 -0.05" size="0.05 0.12 0.04" mass="0"/>'
        text = K1.read_text()
        for side in ("Left", "Right"):
            head, tail = text.split(f'<body name="{side}_Hip_Yaw"', 1)
            tag, tail = tail.split(">", 1)
            text = f'{head}<body name="{side}_Hip_Yaw"{tag}>{thick}{tail}'
        self.write("thick.xml", text)
        pair = '"Left_Hip_Yaw" and "Right_Hip_Yaw" overlap by 4.8 cm at rest'
        checked = self.output_of("check", "thick.xml")
        self.assertIn("so their contact is ignored: ", checked)
        self.assertIn(pair, checked)
        added = self.run_tool("robots", "add", "thick", "--model", "thick.xml")
        self.assert_done(added)
        self.assertIn(pair, unwrapped(added.stderr))
        self.assertIn(pair, (self.folder / "thick/decisions.md").read_text())
        allowed = json.loads((self.folder / "thick/robot.json").read_text())["allowed_self_contact"]
        self.assertIn(["Left_Hip_Yaw", "Right_Hip_Yaw"], allowed)
        options = ("--ik-config", self.folder / "thick/ik.json", "--frames", ":60")
        run = self.run_tool("--bvh", sample("walk"), "--robot-xml", "thick.xml", *options,
                            "--report", "r.json", "-o", "x.csv")
        self.assert_done(run)
        self.assertIn(pair, unwrapped(run.stderr))
        motion = json.loads((self.folder / "r.json").read_text())["motions"][0]
        self.assertEqual(motion["self_1cm_pct"], 0)
        # A missing entry is reported.
        profile = json.loads((self.folder / "thick/robot.json").read_text())
        profile["allowed_self_contact"].remove(["Left_Hip_Yaw", "Right_Hip_Yaw"])
        self.write("thick/robot.json", json.dumps(profile))
        self.assertIn("count as self-collision", self.output_of("check", "thick"))

    def test_estimated_soles_are_reported(self):
        """All uses of a robot with unknown feet warn, and name the missing file."""
        text = K1.read_text().replace("<worldbody>", '<asset><mesh name="foot" file="foot.stl"/></asset><worldbody>')
        for side in ("left", "right"):
            head, tail = text.split(f'<body name="{side}_foot_link">', 1)
            foot, tail = tail.split("</body>", 1)
            foot = "\n".join(line for line in foot.splitlines() if "<geom" not in line)
            text = f'{head}<body name="{side}_foot_link">{foot}<geom type="mesh" mesh="foot"/></body>{tail}'
        self.write("feet.xml", text)
        words = "estimated from the limbs' lengths (2 of 2 mesh files of the model are missing or unreadable"
        self.assertIn(words, self.output_of("check", "feet.xml"))
        added = self.run_tool("robots", "add", "feet", "--model", "feet.xml")
        self.assert_done(added)
        self.assertIn(words, unwrapped(added.stderr))
        self.assertIn(words, self.output_of("check", "feet"))
        for robot in (("--robot", "feet"), ("--robot-xml", "feet.xml", "--ik-config", "feet/ik.json")):
            run = self.run_tool("--bvh", sample("walk"), "--frames", ":30", *robot, "-o", "x.csv")
            self.assert_done(run)
            self.assertIn(words, unwrapped(run.stderr))
            self.assertIn("feet may float or sink", unwrapped(run.stderr))
            self.assertRegex(unwrapped(run.stderr), r"verdict +[0-9]+ of [0-9]+ gates passed.*; soles estimated")
        for options in ((), ("--all",)):
            evaluated = self.run_tool("evaluate", "x.csv", "x.csv", "--robot", "feet", *options)
            self.assertEqual(evaluated.stdout.count(", soles estimated"), 2)
        evaluated = self.run_tool("evaluate", "x.csv", "--robot", "feet", "--json", "x.json")
        self.assertIn(f"note: the soles are {words}", unwrapped(evaluated.stdout))
        self.assertIn("soles estimated", evaluated.stdout.splitlines()[0])
        report, = json.loads((self.folder / "x.json").read_text())["motions"]
        self.assertIn(words, report["estimated_soles"])
        self.assert_done(self.run_tool("view", "x.csv", "--robot", "feet", "--bvh", sample("walk"), "-o", "x.html"))
        motion, = data_of((self.folder / "x.html").read_text())[0]["motions"]
        self.assertTrue(motion["report"]["estimated_soles"])
        known = json.loads(self.run_tool("evaluate", SOURCE / "tests/golden/wave.csv", "--robot", "unitree_g1",
                                         "--json", "-").stdout)
        self.assertIsNone(known["motions"][0]["estimated_soles"])

    def test_a_model_without_its_folder_moves_like_the_robot(self):
        """The G1's own model elsewhere, without a profile: soles and contacts are found, feet stand."""
        folder = SOURCE / "robots/unitree_g1"
        self.write("elsewhere/scene.xml", (folder / "model.xml").read_bytes())
        bare = self.run_tool("--bvh", sample("walk"), "--robot-xml", "elsewhere/scene.xml", "--ik-config",
                             folder / "ik.json", "--scale", "limbs", "--gate", "default", "-o", "bare.csv",
                             "--report", "r.json")
        self.assert_done(bare)
        self.assertIn("from the model's contact geoms", unwrapped(bare.stderr))
        self.assert_done(self.retarget(bvh=sample("walk"), output="whole.csv"))
        motion = json.loads((self.folder / "r.json").read_text())["motions"][0]
        self.assertEqual(motion["float_planted_pct"], 0)
        self.assertLess(motion["contact_height_p50_cm"], 0.2)
        found, wanted = (read_rows((self.folder / name).read_text()) for name in ("bare.csv", "whole.csv"))
        self.assertEqual(len(found), len(wanted))
        for row, whole in zip(found, wanted):
            for i, (value, expected) in enumerate(zip(row, whole)):
                self.assertAlmostEqual(value, expected, delta=0.01 if i < 3 else 0.05)

    def test_a_model_in_the_working_directory(self):
        self.write("model.xml", K1.read_bytes())
        bare, dotted = (self.run_tool("robots", "check", name) for name in ("model.xml",
                                                                            "./model.xml"))
        self.assertEqual((bare.returncode, bare.stdout.replace("model.xml", "./model.xml")),
                         (dotted.returncode, dotted.stdout))
        self.assertNotIn("error", bare.stderr)

    def test_names_are_printed_safely(self):
        for file in (SOURCE / "robots/unitree_g1").iterdir():
            if file.is_file():
                self.write(f"odd/{file.name}", file.read_bytes())
        profile = json.loads((self.folder / "odd/robot.json").read_text())
        odd = "\x1b[2J\x9b2J\u202egpj"
        profile.update(description=odd, licence=odd, joint_ordr=[])
        self.write("odd/robot.json", json.dumps(profile))
        checked = self.run_tool("robots", "check", "odd")
        del profile["joint_ordr"]
        profile["limit_sets"][odd] = profile["limit_sets"]["official"]
        self.write("odd/robot.json", json.dumps(profile))
        shown = self.run_tool("robots", "show", "odd")
        self.assertIn("?[2J?2J?gpj", shown.stdout)
        printed = self.run_tool("robots", "show", "odd", "--json")
        self.assertEqual(json.loads(printed.stdout)["description"], odd)
        self.write(f"x{odd}.bvh", short_clip("wave", 2).replace(b"JOINT Spine", b"JOINT Sp\xc2\x9bine"))
        inspected = self.run_tool("inspect", f"x{odd}.bvh")
        failed = self.run_tool("inspect", odd)
        for result in (checked, shown, printed, inspected, failed):
            for text in (result.stdout, result.stderr):
                self.assertFalse(set("\x1b\x9b\u202e") & set(text), text)

    def test_inaccessible_files_are_errors(self):
        for file in (SOURCE / "robots/unverified/booster_k1").iterdir():
            if file.is_file():
                self.write(f"mine/{file.name}", file.read_bytes())
        for name in ("robot.json", "ik.json"):
            path = self.folder / "mine" / name
            content = path.read_bytes() if path.exists() else None
            path.unlink(missing_ok=True)
            path.symlink_to(name)  # points to itself
            result = self.retarget(robot="mine")
            self.assert_fails(result, 4, f"mine/{name}", "cannot access the file")
            path.unlink()
            if content is not None:
                path.write_bytes(content)

    def test_force_replaces_only_robots(self):
        self.write("mine.xml", K1.read_bytes())
        kept = self.write("mine/thesis.txt", "years")
        add = ("robots", "add", "mine", "--model", "mine.xml", "--force")
        self.assert_fails(self.run_tool(*add), 2, "mine", "robots add did not create it")
        self.assertEqual(kept.read_text(), "years")
        for _ in range(2):
            self.assert_done(self.run_tool("robots", "add", "new", "--model", "mine.xml",
                                           "--force"))
        # The model must not be in the replaced folder.
        inside = self.run_tool("robots", "add", "new", "--model", "new/model.xml", "--force")
        self.assert_fails(inside, 2, "new/model.xml")
        self.assertTrue((self.folder / "new/model.xml").exists())

    def test_robot_names_must_not_be_parent_folders(self):
        for file in (SOURCE / "robots/unitree_g1").iterdir():
            if file.is_file():
                self.write(f"bad/{file.name}", file.read_bytes())
        profile = json.loads((self.folder / "bad/robot.json").read_text())
        self.write("bad/robot.json", json.dumps({**profile, "name": ".."}))
        self.write("in/a.bvh", short_clip("wave", 2))
        before = self.files()
        for robots in ("bad", "bad,unitree_h1"):
            result = self.run_tool("batch", "in", "-o", "out", "--robot", robots, "--method", "gmr")
            self.assert_fails(result, 4, '"name"', '".."')
        self.assertEqual(self.files(), before)
        # A model file without a usable name.
        self.write("...xml", (SOURCE / "robots/unitree_g1/model.xml").read_bytes())
        self.assert_done(self.run_tool(
            "batch", "in", "-o", "out", "--robot-xml", "...xml", "--ik-config",
            SOURCE / "configs/lafan1_to_unitree_g1.json", "--method", "gmr", "--no-quality"))
        self.assertEqual(json.loads((self.folder / "out/manifest.jsonl").read_text())["robot"],
                         "model")

    def test_check_reports_every_fault(self):
        config = (SOURCE / "robots/unverified/booster_k1/ik.json").read_text()
        self.write("odd/model.xml", K1.read_bytes())
        self.write("odd/ik.json", config.replace('"Left_Shank"', '"Left_Shnak"')
                   .replace('["RightUpLeg"', '["RightUpLge"'))
        result = self.run_tool("robots", "check", "odd")
        self.assertEqual(result.returncode, 4, result.stderr)
        self.assertIn("Left_Shnak", result.stdout)
        self.assertIn("RightUpLge", result.stdout)
        self.assertIn("note: the soles are unknown", result.stdout)

    def test_the_list_contains_robots_with_errors(self):
        self.write("own/retarget/robots/mine/model.xml", K1.read_bytes())
        self.write("own/retarget/robots/mine/robot.json", '{"name": "mine",\n "name": "mine"}')
        env = self.tool_environment(XDG_DATA_HOME=str(self.folder / "own"))
        listed = self.run_tool("robots", "list", env=env)
        self.assert_done(listed)
        broken, = (line for line in listed.stdout.splitlines() if line.startswith("mine "))
        self.assertRegex(broken, r'error: .*mine/robot\.json:2:2: invalid JSON: the key "name" occurs twice')
        self.assertEqual(len(listed.stdout.splitlines()), len(self.output_of("list").splitlines()) + 1)
        listed = self.run_tool("robots", "list", "--json", env=env)
        self.assert_done(listed)
        errors = {robot["name"]: robot["error"] for robot in json.loads(listed.stdout)}
        self.assertIn("robot.json:2:2", errors.pop("mine"))
        self.assertEqual(set(errors.values()), {None})
        checked = self.run_tool("robots", "check", "mine", env=env)
        self.assertEqual(checked.returncode, 4)
        self.assertIn("robot.json:2:2: invalid JSON", checked.stdout)
        self.assertNotIn("note:", checked.stdout)

    def test_limits_in_degrees_are_rejected(self):
        self.write("limits.json", json.dumps({"left_knee_joint": [0, 120]}))
        result = self.retarget("--limits", "limits.json", bvh=sample("walk"), output="x.csv")
        self.assert_fails(result, 4, "limits.json", "ranges reach 120 rad, which looks like degrees")

    def test_a_folder_with_the_name_of_an_installed_robot(self):
        self.write("k1.xml", K1.read_bytes())
        added = self.run_tool("robots", "add", "unitree_g1", "--model", "k1.xml", "-o", "mine")
        self.assert_done(added)
        self.assertIn("an installed robot has the same name: select yours by its path, mine/unitree_g1", added.stderr)
        (self.folder / "mine/unitree_g1").rename(self.folder / "unitree_g1")
        run = ("--frames", ":10", "--method", "gmr")
        own = self.retarget(*run, robot="./unitree_g1", bvh=sample("walk"), output="-")
        self.assert_done(own)
        self.assertEqual(len(read_rows(own.stdout)[0]), 7 + 22)
        installed = self.retarget(*run, robot="unitree_g1", bvh=sample("walk"), output="-")
        self.assert_done(installed)
        self.assertEqual(len(read_rows(installed.stdout)[0]), 7 + 29)
        self.assertIn("./unitree_g1 selects it", installed.stderr)
        for action in ("check", "show"):
            self.assertIn("./unitree_g1 selects it", self.run_tool("robots", action, "unitree_g1").stderr)
            self.assertEqual(self.run_tool("robots", action, "./unitree_g1").stderr, "")
        self.assert_fails(self.retarget(*run, robot="./unitree_h1", bvh=sample("walk"), output="-"), 4, "./unitree_h1")

    def test_a_folder_with_the_short_name_of_a_robot(self):
        self.write("k1.xml", K1.read_bytes())
        self.assert_done(self.run_tool("robots", "add", "g1", "--model", "k1.xml"))
        warning = "using the folder g1 here, not the robot unitree_g1: its full name selects it"
        run = {"bvh": sample("walk"), "output": "-"}
        short = self.retarget("--frames", ":10", "--method", "gmr", robot="g1", **run)
        self.assert_done(short)
        self.assertEqual(len(read_rows(short.stdout)[0]), 7 + 22)
        self.assertIn(warning, unwrapped(short.stderr))
        by_path = self.retarget("--frames", ":10", "--method", "gmr", robot="./g1", **run)
        self.assertNotIn("not the robot", by_path.stderr)
        self.assertIn(warning, unwrapped(self.run_tool("robots", "show", "g1").stderr))

    def test_robots_added_to_the_folder_of_the_user(self):
        self.write("k1.xml", K1.read_bytes())
        (self.folder / "own/retarget").mkdir(parents=True)
        env = self.tool_environment(XDG_DATA_HOME=str(self.folder / "own"))
        add = ("robots", "add", "mine", "--model", "k1.xml", "-o")
        added = self.run_tool(*add, "own/retarget/robots", env=env)
        self.assert_done(added)
        self.assertNotIn("same name", added.stderr)
        other = self.run_tool(*add, ".", env=env)
        self.assert_done(other)
        self.assertIn("an installed robot has the same name", unwrapped(other.stderr))

    def test_show_names_the_configuration_of_the_default_method(self):
        robot = json.loads(self.output_of("show", "unitree_g1", "--json"))
        self.assertTrue(robot["mapping_file"].endswith("ik.json"), robot["mapping_file"])
        self.assertTrue(robot["mapping_file_published"].endswith("lafan1_to_unitree_g1.json"))

    def test_rejected_models(self):
        self.write("arm.xml", "<mujoco><worldbody><body><freejoint/><geom size='1'/><body><joint/>"
                   "<geom size='1'/></body></body></worldbody></mujoco>")
        self.assert_fails(self.run_tool("robots", "add", "arm", "--model", "arm.xml"), 4, "arm")
        self.assert_fails(self.run_tool("robots", "add", "a/b", "--model", "arm.xml"), 2, "a/b")
        self.assert_fails(self.run_tool("robots", "add", "x", "--model", "no.xml"), 4, "no.xml")
        self.assert_fails(self.run_tool("robots", "show", "unitree_g2"), 4, "unitree_g1")
        self.assert_fails(self.run_tool("robots"), 2)
        # The destination is checked before the model.
        self.assert_fails(self.run_tool("robots", "add", "x", "--model", "arm.xml", "-o", "nowhere/deep"), 2,
                          'the folder "nowhere" does not exist')
        self.assert_fails(self.run_tool("robots", "add", "x", "--model", "arm.xml", "-o", "arm.xml"), 2,
                          '"arm.xml" is not a folder')
        self.write("arm/thesis.txt", "years")
        self.assert_fails(self.run_tool("robots", "add", "arm", "--model", "arm.xml"), 2, "--force")
        self.assertEqual(self.files(), ["arm.xml", "arm/thesis.txt"])

    def test_compare_with_another_model(self):
        self.write("same.xml", K1.read_bytes())
        same = self.run_tool("robots", "compare", "booster_k1", "--model", "same.xml")
        self.assert_done(same)
        self.assertIn("are equal", same.stdout)
        text = K1.read_text()
        head, tail = text.split('<body name="Left_Arm_1" pos="0 0.077 0.1845">', 1)
        moved = f'{head}<body name="Left_Arm_1" pos="0 0.077 0.2005">{tail}'
        joint = re.search(r'<joint name="Right_Elbow_Pitch"[^>]*range="([^"]*)"', moved)
        moved = moved.replace(joint[0], joint[0].replace(joint[1], "-1 1"))
        self.write("new.xml", moved.replace("AAHead_yaw", "Head_yaw"))
        differs = self.run_tool("robots", "compare", "booster_k1", "--model", "new.xml")
        self.assertEqual(differs.returncode, 1, differs.stderr)
        for words in ("positions of axes: ", " 16 mm", "body positions in 32 configurations: ", "ranges: ",
                      "Right_Elbow_Pitch", "joints that the model lacks: AAHead_yaw", "joints that the robot lacks: Head_yaw"):
            self.assertIn(words, unwrapped(differs.stdout))

    def test_the_table_of_revisions_is_that_of_the_profiles(self):
        table = (SOURCE / "docs/robots.md").read_text(encoding="utf-8").split("## Revisions")[1].split("## Unitree G1")[0]
        rows = {row.split("`")[1]: row for row in table.splitlines() if row.startswith("| `")}
        profiles = {path.parent.name: json.loads(path.read_text()) for path in SOURCE.glob("robots/**/robot.json")}
        self.assertEqual(set(rows), set(profiles))
        for name, row in rows.items():
            profile = profiles[name]
            expected = [profile.get(key, "not recorded") for key in ("revision", "revision_date")]
            self.assertEqual(row.strip("| ").split(" | ")[2:], expected, name)
            stated = re.findall(r"\b[0-9a-f]{7}\b", profile.get("revision", ""))
            self.assertEqual(set(stated), set(re.findall(r"revision ([0-9a-f]{7})", profile["source"])), name)

    def test_overlaps_are_one_note(self):
        """Hips and thighs of both sides overlap: one note has the first of them, decisions.md all."""
        ball = '<geom type="sphere" size="0.25" mass="0"/>'
        text = K1.read_text()
        for body in ("Left_Hip_Yaw", "Right_Hip_Yaw", "Left_Shank", "Right_Shank", "Trunk"):
            head, tail = text.split(f'<body name="{body}"', 1)
            tag, tail = tail.split(">", 1)
            text = f'{head}<body name="{body}"{tag}>{ball}{tail}'
        self.write("thick.xml", text)
        added = self.run_tool("robots", "add", "thick", "--model", "thick.xml")
        self.assert_done(added)
        messages = unwrapped(added.stderr)
        self.assertEqual(messages.count("their contact is ignored"), 1)
        self.assertRegex(messages, r"and [0-9]+ more")
        decisions = (self.folder / "thick/decisions.md").read_text()
        self.assertGreater(decisions.split("## Overlaps")[1].count(" overlap "), 8)


if __name__ == "__main__":
    unittest.main()
