"""The main command: its output files and their contents."""

import math
import os
import re
import subprocess
import sys
import unittest

from optional_numpy import numpy
from tool import SAMPLES, SOURCE, TOOL, ToolTest, difference, needs_posix, read_rows, sample, short_clip


class Output(ToolTest):
    def text(self, *arguments, **options):
        result = self.retarget(*arguments, output="-", **options)
        self.assert_done(result)
        return result.stdout

    def test_bytes_are_those_of_the_published_data(self):
        self.assert_done(self.retarget())
        data = (self.folder / "out.csv").read_bytes()
        self.assertEqual(self.files(), ["out.csv"])
        self.assertRegex(data, rb"\A(-?\d+\.\d{6}(,-?\d+\.\d{6}){35}\n)+\Z")
        self.assertNotIn(b"-0.000000", data)

    @unittest.skipIf(numpy is None, "numpy is missing")
    def test_numpy_reads_36_columns(self):
        self.assert_done(self.retarget(bvh=sample("walk")))
        rows = numpy.loadtxt(self.folder / "out.csv", delimiter=",")
        self.assertEqual(rows.shape, (301, 36))
        norms = numpy.linalg.norm(rows[:, 3:7], axis=1)
        self.assertLess(abs(norms - 1).max(), 2e-6)
        self.assertGreater((rows[1:, 3:7] * rows[:-1, 3:7]).sum(axis=1).min(), 0)
        # Upright, at a plausible height, over the scaled distance of the human.
        self.assertTrue(0.6 < rows[:, 2].min() and rows[:, 2].max() < 0.95)
        self.assertTrue(5.5 < math.hypot(*(rows[-1, :2] - rows[0, :2])) < 7.5)

    def test_goldens(self):
        for name in SAMPLES:
            with self.subTest(sample=name):
                golden = (SOURCE / "tests/golden" / f"{name}.csv").read_text()
                found = self.text("--method", "gmr", "--precision", 9, bvh=sample(name))
                self.assertIsNone(difference(read_rows(found), read_rows(golden), 1e-6))

    def test_same_input_gives_the_same_bytes(self):
        self.assertEqual(self.text(), self.text())

    def test_dialects_hold_the_same_numbers(self):
        plain = read_rows(self.text())
        spaced = self.text("--csv-delimiter", "space")
        self.assertEqual(read_rows(spaced.replace(" ", ",")), plain)
        tabbed = self.text("--csv-delimiter", "tab")
        self.assertEqual(read_rows(tabbed.replace("\t", ",")), plain)
        header, body = self.text("--csv-header").split("\n", 1)
        self.assertEqual(read_rows(body), plain)
        names = header.split(",")
        self.assertEqual(names[:8], ["root_x", "root_y", "root_z", "root_qx", "root_qy",
                                     "root_qz", "root_qw", "left_hip_pitch_joint"])
        self.assertEqual((len(names), names[-1]), (36, "right_wrist_yaw_joint"))
        turned = read_rows(self.text("--csv-quat", "wxyz"))
        self.assertEqual([r[:3] + r[4:7] + r[3:4] + r[7:] for r in turned], plain)

    def test_standard_input_and_output(self):
        with open(sample("wave"), "rb") as clip:
            piped = self.retarget(bvh="-", output="-", stdin=clip)
        self.assert_done(piped)
        self.assertEqual(piped.stdout, self.text())
        self.assertEqual(self.files(), [])

    def test_normalized_start(self):
        plain = read_rows(self.text("--precision", 9))
        rows = read_rows(self.text("--precision", 9, "--normalize-start"))
        x, y, z, qx, qy, qz, qw = rows[0][:7]
        self.assertLess(max(abs(x), abs(y)), 1e-8)
        self.assertLess(abs(math.atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))), 1e-8)
        for before, after in zip(plain, rows):
            self.assertEqual(before[2], after[2])
            self.assertEqual(before[7:], after[7:])
            moved = [math.dist(a[:2], b[:2]) for a, b in ((before, plain[0]), (after, rows[0]))]
            self.assertAlmostEqual(*moved, places=7)

    def test_rate_and_range(self):
        frames = lambda *arguments: len(read_rows(self.text(*arguments)))
        whole = frames()
        self.assertEqual(frames("--fps", "source"), whole)
        self.assertEqual(frames("--fps", 60), 2 * whole - 1)
        self.assertEqual(frames("--source-fps", 60), (whole - 1) // 2 + 1)
        self.assertEqual(frames("--frames", "10:25"), 15)
        self.assertEqual(frames("--start", 1, "--end", 2), 31)
        self.assertEqual(frames("--fps", 10, "--start", 1, "--end", 2, "--interpolation", "linear",
                                "--no-antialias"), 11)

    def test_limits(self):
        rows = lambda *options: read_rows(self.text(*options, bvh=sample("get_up")))
        official = rows("--method", "gmr", "--limits", "official")
        gmr = rows("--method", "gmr", "--limits", "gmr")
        self.assertEqual(gmr, rows("--method", "gmr"))
        self.assertEqual(rows("--limits", "official"), rows())
        hip = lambda rows: min(row[7] for row in rows)
        self.assertLess(hip(official), -1.6)  # beyond what the tighter set allows
        self.assertGreaterEqual(hip(gmr), -1.57 - 1e-6)
        self.write("knees.json", '{"left_knee_joint": [0.5, 1.0]}')
        knees = [row[10] for row in read_rows(self.text("--limits", "knees.json"))]
        self.assertTrue(all(0.5 <= q <= 1.0 for q in knees), min(knees))
        rows = read_rows(self.text("--method", "gmr", "--limits", "knees.json"))
        knees = [row[10] for row in rows]
        self.assertTrue(all(0.5 - 1e-3 <= q <= 1.0 for q in knees[5:]), min(knees))

    def test_variants_hold_joints_and_leave_them_out(self):
        whole = self.text("--csv-header").splitlines()[0].split(",")
        self.assertEqual(self.text("--dof", 29), self.text())
        for name, count, held in (("27", 34, ("waist_roll", "waist_pitch")),
                                  ("23", 30, ("waist_roll", "waist_pitch", "wrist_pitch",
                                              "wrist_yaw")),
                                  ("23-pbhc", 30, ("wrist",))):
            header, body = self.text("--dof", name, "--csv-header").split("\n", 1)
            left = [joint for joint in whole if not any(word in joint for word in held)]
            self.assertEqual(header.split(","), left)
            self.assertEqual({len(row) for row in read_rows(body)}, {count})
        self.assertIn("23 joints", self.retarget("--dof", "23-pbhc").stderr)
        self.assert_fails(self.retarget("--dof", "23pbhc"), 4, "unitree_g1", '"23-pbhc"?',
                          "29, 27, 23, 23-pbhc")
        self.assert_fails(self.retarget("--dof", 20, robot="fourier_n1"), 4, "23 joints")

    def test_fingers_stay_at_zero_and_do_not_affect_other_joints(self):
        off = self.text("--csv-header", "--hands", "off", robot="unitree_g1_with_hands")
        header, body = off.split("\n", 1)
        rows = read_rows(body)
        fingers = [i for i, name in enumerate(header.split(",")) if "_hand_" in name]
        self.assertEqual(len(fingers), 14)
        self.assertEqual({row[i] for row in rows for i in fingers}, {0.0})
        # A source without fingers: half open, in all frames.
        relaxed = read_rows(self.text(robot="unitree_g1_with_hands"))
        self.assertEqual(len({tuple(row[i] for i in fingers) for row in relaxed}), 1)
        self.assertGreater(min(abs(relaxed[0][i]) for i in fingers if "thumb" not in
                               header.split(",")[i]), 0.3)
        # The fit keeps these wider hands away from the body; the published method has no hands.
        others = [i for i in range(len(rows[0])) if i not in fingers]
        body = [[[row[i] for i in others] for row in each] for each in (relaxed, rows)]
        self.assertIsNone(difference(*body, 0.3))
        self.assertIsNotNone(difference(*body, 1e-4))
        exact = lambda *options, **robot: read_rows(self.text("--method", "gmr", *options, **robot))
        plain = exact()
        rest = [[row[i] for i in others] for row in exact(robot="unitree_g1_with_hands")]
        self.assertIsNone(difference(rest, plain, 2e-6))
        rows = exact("--dof", 29, robot="unitree_g1_with_hands")
        self.assertIsNone(difference(rows, plain, 2e-6))

    def test_summary_names_joints_at_a_limit_and_the_tasks_that_push_them(self):
        self.write("knees.json", '{"left_knee_joint": [0, 0.3]}')
        # By default the fit keeps joints off their limits.
        self.write("fit.json", '{"limit_margin_weight": 0}')
        summary = self.retarget("--limits", "knees.json", "--fit-config", "fit.json", bvh=sample("squat")).stderr
        self.assertRegex(summary, r"left_knee_joint at its upper limit in \d+ % of frames; task "
                                  r"Left\w+ (rotation|position), [\d.]+ (degrees|cm) short; "
                                  r"limit set knees.json is 2.58 rad tighter than official")
        self.assertNotIn("tighter", self.retarget("--limits", "official").stderr)

    def test_another_model_with_its_configuration(self):
        model = SOURCE / "robots/unitree_g1/model.xml"
        config = SOURCE / "configs/lafan1_to_unitree_g1.json"
        plain = read_rows(self.text("--method", "gmr", "--limits", "official"))
        words = ("--bvh", sample("wave"), "--robot-xml", model, "--ik-config", config, "-o", "-")
        result = self.run_tool(*words, "--method", "gmr")
        self.assert_done(result)
        self.assertEqual(read_rows(result.stdout), plain)
        # Without a profile, soles are found in the model: feet neither float nor slip.
        words = ("--bvh", sample("turn_in_place"), *words[2:])
        result = self.run_tool(*words)
        self.assert_done(result)
        self.assertIn("soles    from the model's contact geoms", result.stderr)
        self.assertIn("verdict  35 of 36 gates passed, 1 not measured", result.stderr)
        self.write("bare.csv", result.stdout)
        evaluated = self.run_tool("evaluate", "bare.csv", "--robot", "unitree_g1", "--bvh",
                                  sample("turn_in_place"))
        self.assertEqual(evaluated.returncode, 0, evaluated.stdout)
        words = ("--bvh", sample("wave"), *words[2:])
        profile = ("--robot-profile", SOURCE / "robots/unitree_g1/robot.json")
        self.assertEqual(self.run_tool(*words, *profile).stdout,
                         self.text("--ik-config", "published"))

    def test_unknown_soles_cause_a_warning(self):
        model = (SOURCE / "robots/unitree_g1/model.xml").read_text()
        bare = self.write("bare.xml", model.replace("<geom ", '<geom contype="0" conaffinity="0" '))
        config = SOURCE / "configs/lafan1_to_unitree_g1.json"
        words = ("--bvh", sample("wave"), "--ik-config", config, "-o", "out.csv")
        result = self.run_tool(*words, "--robot-xml", bare)
        self.assert_done(result)
        self.assertIn("warning: the soles are estimated from the leg lengths", result.stderr)
        # A profile without soles is no better than none.
        profile = self.write("robot.json", '{"name": "mine"}')
        result = self.run_tool(*words, "--robot-xml", bare, "--robot-profile", profile)
        self.assertIn("warning: the soles are estimated from the leg lengths", result.stderr)

    def test_summary_lists_all_decisions(self):
        summary = self.retarget().stderr
        for words in ("22 joints", "30 fps", "centimetres, Y up", "unitree_g1, 29 joints",
                      "limits official", "contact phases", "IK steps per frame", "is nearest to a limit",
                      "wrote"):
            self.assertIn(words, summary)
        self.assertNotIn("costs", summary)
        self.assertRegex(self.retarget("--verbose").stderr, r"costs +position [\d.]+ -> ")
        self.assertIn("limits gmr", self.retarget("--method", "gmr").stderr)
        self.assertEqual(self.retarget("--quiet").stderr, "")
        self.assertNotIn("\033", summary)

    def test_summary_ends_with_a_verdict(self):
        # A lying body has the same gates.
        said = "\n".join(self.retarget(bvh=sample("get_up")).stderr.splitlines()[-1:])
        self.assertRegex(said, r"^verdict  36 of 36 gates passed$")
        self.write("fit.json", '{"limit_margin_weight": 0}')
        free = self.retarget("--fit-config", "fit.json", bvh=sample("get_up")).stderr
        self.assertRegex(free, r"verdict  .*; \w+ at its limit in \d+ % of frames")
        *_, missed, verdict = self.retarget("--method", "gmr").stderr.splitlines()
        self.assertRegex(missed, r"^missed   .*stance_height_p50_cm [\d.]+ \(at most 0.3\)")
        self.assertRegex(verdict, r"^verdict  \d+ of 36 gates passed")
        # Small robots have small bounds: 0.002 m/s for legs of 0.632 m become 0.00073 for 0.231.
        small = self.run_tool("--bvh", sample("squat"), "--robot", "stanford_toddy", "--method",
                              "gmr", "-o", "small.csv")
        self.assertRegex(small.stderr, r"stance_slip_mean [\d.]+ \(at most 0.00073\)")
        # Equals the report of evaluate, except that a file does not record whether the solver
        # failed.
        kept, gates = map(int, re.findall(r"\d+", verdict)[:2])
        evaluated = self.run_tool("evaluate", "out.csv", "--robot", "unitree_g1", "--bvh", sample("wave"),
                                  "--ik-config", "published")
        self.assertIn(f"verdict  out.csv: {kept - 1} of {gates - 1} gates passed", evaluated.stderr)
        # Precision too low for a quaternion spoils the verdict but not the run.
        self.assertIn("wrote", self.retarget("--precision", "0", "--method", "gmr").stderr)

    def on_a_terminal(self, *words):
        """The output of a run whose standard error is a terminal."""
        master, terminal = os.openpty()
        self.addCleanup(os.close, master)
        run = subprocess.Popen([TOOL, "--bvh", sample("squat"), "--robot", "unitree_g1", "-o",
                                "out.csv", *words], cwd=self.folder, stdin=subprocess.DEVNULL,
                               stdout=subprocess.DEVNULL, stderr=terminal)
        os.close(terminal)
        text = b""
        try:
            while part := os.read(master, 65536):
                text += part
        except OSError:
            pass  # Linux reports this when the other end is closed.
        run.wait(timeout=300)
        # Progress lines are overwritten.
        lines = text.decode().replace("\r\n", "\n").split("\n")
        return [re.sub(r"\x1b\[[0-9;]*[mK]", "", line.split("\r")[-1]) for line in lines]

    @needs_posix
    def test_nothing_is_broken_by_a_terminal_of_80_columns(self):
        for words in ((), ("--verbose",), ("--method", "gmr"), ("--limits", "official"),
                      ("--fps", "x"), ("--robot-xml", "x.xml"), ("--start", "900")):
            lines = self.on_a_terminal(*words)
            self.assertTrue(any(lines))
            for line in lines:
                if not any(len(word) > 40 for word in line.split()):
                    self.assertLessEqual(len(line), 80, line)

    def test_piped_messages_have_one_line_each(self):
        bad = self.write("a_file_with_quite_a_long_name_for_a_clip.bvh",
                         short_clip("wave", 3).replace(b"Frame Time", b"Frame Tim", 1))
        lines = self.retarget(bvh=bad).printed.splitlines()
        self.assertEqual(len([line for line in lines if line.startswith(str(bad))]), 1)
        self.assertGreater(len(lines[0]), 80)

    def test_messages_about_the_floor(self):
        head, rows = sample("wave").read_text().split("Frame Time:", 1)
        time, *rows = rows.splitlines()

        def shifted(up):
            moved = [" ".join([x, str(float(y) + up), *rest])
                     for x, y, *rest in (row.split() for row in rows)]
            return self.write("x.bvh", "\n".join([f"{head}Frame Time:{time}", *moved]) + "\n")

        for up, words in ((50, r"targets lowered by \d"), (-50, r"targets raised by \d")):
            self.assertRegex(self.retarget(bvh=shifted(up)).stderr, words)

    def test_version_and_help(self):
        version = self.run_tool("--version")
        self.assert_done(version)
        self.assertRegex(version.stdout, r"retarget \d+\.\d+\.\d+")
        self.assertRegex(version.stdout, r"MuJoCo \d+\.\d+\.\d+")
        self.assertRegex(version.stdout, r"Eigen \d+\.\d+\.\d+")
        help_text = self.run_tool("--help")
        self.assert_done(help_text)
        offered = help_text.stdout
        for command in (["inspect"], ["edit", "rest"], ["edit", "transfer"], ["edit", "lafan"],
                        ["evaluate"], ["robots", "list"], ["robots", "check"], ["robots", "add"],
                        ["edit", "concat"], ["edit", "path"], ["batch"], ["convert"], ["compare"],
                        ["verify"], ["view"]):
            offered += self.run_tool(*command, "--help").stdout
        for line in (SOURCE / "README.md").read_text().splitlines():
            if re.match(r" +retarget ", line):
                for option in re.findall(r" (-[a-z]|--[a-z-]+)\b", line):
                    self.assertIn(option, offered, "README names " + option)


class Samples(ToolTest):
    def test_generator_writes_the_committed_clips(self):
        if numpy is None:
            self.skipTest("numpy is missing")
        for command in (["tools/samples/make_samples.py", "--check", "data/"],
                        ["tests/samples/check_samples.py", "data/"]):
            result = subprocess.run([sys.executable, *command], cwd=SOURCE, text=True,
                                    capture_output=True, timeout=300)
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)


if __name__ == "__main__":
    unittest.main()
