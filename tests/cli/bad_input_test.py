"""Bad input: one clear line, the right exit code, and nothing left behind."""

import os
import resource
import shlex
import signal
import subprocess
import time
import unittest

from tool import SOURCE, TOOL, ToolTest, needs_posix, sample, short_clip


class BadInput(ToolTest):
    def assert_refused(self, result, code, *words):
        self.assert_fails(result, code, *words)
        self.assertEqual([f for f in self.files() if "out" in f], [])

    def test_usage(self):
        run = self.run_tool
        self.assert_refused(run(), 2, "no motion file")
        self.assert_refused(run("--bvh", sample("wave")), 2, "no robot")
        self.assert_refused(run("--bvh", sample("wave"), "--robot", "unitree_g1"), 2, "no output")
        self.assert_refused(self.retarget("--robot-xml", "x.xml"), 2, "--robot and --robot-xml")
        self.assert_refused(self.retarget("--robot-profile", "x.json"), 2, "--robot-profile")
        self.assert_refused(self.retarget("--fps", "fast"), 2, "\"fast\"")
        self.assert_refused(self.retarget("--fps", "0"), 2, "--fps")
        self.assert_refused(self.retarget("--frames", "1:2", "--start", 1), 2, "--frames")
        self.assert_refused(self.retarget("--frames", "5000:"), 2)
        self.assert_refused(self.retarget("--start", 900), 2)
        self.assert_refused(self.retarget(output="out.npz"), 2, ".npz")
        self.assert_refused(self.retarget(output="no/such/out.csv"), 2, "no/such", "mkdir")
        for option in ("--no-such-option", "--precision=x", "--method=magic", "--csv-quat=zyxw"):
            result = self.retarget(option)
            self.assertEqual(result.returncode, 2, option)
            self.assertEqual(self.files(), [])

    def test_messages_for_wrong_options(self):
        self.assert_refused(self.retarget("--limit", "x"), 2, "--limit ", 'did you mean "--limits"')
        self.assert_refused(self.run_tool("walk.bvh"), 2, "no robot and no output")
        for option in ("--source-fps", "--start", "--end"):
            for value in ("nan", "inf", "-1", "1e300", "x"):
                self.assert_refused(self.retarget(f"{option}={value}"), 2, option, value)
        for value in ("nan", "inf", "-30", "1e300"):
            self.assert_refused(self.retarget(f"--fps={value}"), 2, "--fps", value)

    def test_parts_beyond_the_clip_are_reported(self):
        gmr = ("--method", "gmr")
        for options in (("--frames", "290:4000"), ("--start", "9", "--end", "60")):
            result = self.retarget(*gmr, *options, bvh=sample("walk"))
            self.assert_done(result)
            self.assertRegex(result.stderr, "warning: .* after the clip, which (has frames 0 to 300|ends at 10 s)")
        edited = self.run_tool("edit", "trim", sample("walk"), "--frames", "290:4000", "-o", "part.bvh")
        self.assertIn("which has frames 0 to 300", edited.stderr)
        for options in (("--frames", "290:"), ("--frames", "290:301"), ("--start", "9", "--end", "10")):
            self.assertNotIn("after the clip", self.retarget(*gmr, *options, bvh=sample("walk")).stderr)

    def test_output_over_the_input(self):
        clip = self.write("clip.bvh", sample("wave").read_bytes())
        self.assert_fails(self.retarget(bvh=clip, output="clip.bvh"), 2, "overwrite")
        self.assertEqual(clip.read_bytes(), sample("wave").read_bytes())

    def test_motion_files(self):
        self.assert_refused(self.retarget(bvh="missing.bvh"), 3, "missing.bvh")
        self.assert_refused(self.retarget(bvh=self.folder), 3, "directory")
        self.assert_refused(self.retarget(bvh=self.write("empty.bvh", "")), 3, "empty")
        text = sample("wave").read_text()
        self.assert_refused(self.retarget(bvh=self.write("cut.bvh", text[: len(text) // 2])), 3,
                            "cut.bvh:")
        lines = text.splitlines()
        lines[-3] = lines[-3].replace(lines[-3].split()[7], "nan", 1)
        self.assert_refused(self.retarget(bvh=self.write("nan.bvh", "\n".join(lines))), 3,
                            f"nan.bvh:{len(lines) - 2}:")
        head = text[: text.index("Frames:")]
        self.assert_refused(
            self.retarget(bvh=self.write("none.bvh", head + "Frames: 0\nFrame Time: 0.033333\n")),
            3, "no frames")

    def test_skeleton_without_a_mapped_bone(self):
        clip = self.write("clip.bvh", sample("wave").read_text().replace("JOINT Head", "JOINT Pincer"))
        config = (SOURCE / "configs/lafan1_to_unitree_g1.json").read_text()
        config = self.write("config.json", config.replace('"LeftHand"', '"Head"'))
        self.assert_refused(self.retarget("--ik-config", config, bvh=clip), 3, "Head", "Pincer",
                            "RightHand")

    def test_unreadable_file(self):
        if os.geteuid() == 0:
            self.skipTest("root reads everything")
        clip = self.write("secret.bvh", sample("wave").read_bytes())
        clip.chmod(0)
        self.assert_refused(self.retarget(bvh=clip), 3, "secret.bvh", "ermission")

    def test_robots(self):
        self.assert_refused(self.retarget(robot="unitre_g1"), 4, "did you mean \"unitree_g1\"")
        self.assert_refused(self.retarget(robot="atlas"), 4, "unitree_g1")
        self.assert_refused(self.retarget("--limits", "oficial"), 4, "did you mean \"official\"")
        self.assert_refused(self.retarget("--data-dir", self.folder), 4, "robots")

    def test_models(self):
        config = SOURCE / "configs/lafan1_to_unitree_g1.json"

        def with_model(text):
            model = self.write("model.xml", text)
            return self.run_tool("--bvh", sample("wave"), "--robot-xml", model, "--ik-config",
                                 config, "-o", "out.csv")

        body = "<geom size='.1'/></body></worldbody></mujoco>"
        self.assert_refused(with_model(""), 4, "model.xml")
        self.assert_refused(with_model("<mujoco>\n<worldbody>\n<oops/>" + body), 4, "model.xml:")
        self.assert_refused(with_model("<mujoco><worldbody><body name='pelvis'>" + body), 4,
                            "no free joint")
        free = "<mujoco><worldbody><body name='pelvis'><freejoint/>" + body
        self.assert_refused(with_model(free), 4, "left_knee_link", "errors")
        door = ("</body><body name='door'><joint name='hinge'/><geom size='.1'/></body>"
                "</worldbody></mujoco>")
        self.assert_refused(with_model(free.replace("</body></worldbody></mujoco>", door)), 4,
                            '"hinge"', "one robot")
        self.assertFalse((self.folder / "MUJOCO_LOG.TXT").exists())

    def test_retargeting_configurations(self):
        broken = self.write("config.json", '{\n  "robot_root_name": "pelvis",\n  oops\n}\n')
        self.assert_refused(self.retarget("--ik-config", broken), 4, "config.json:3:3:")
        self.assert_refused(self.retarget("--ik-config", "missing.json"), 4, "missing.json")
        text = (SOURCE / "configs/lafan1_to_unitree_g1.json").read_text()
        wrong = text.replace("left_knee_link", "left_kne_link").replace('"LeftHand"', '"LeftHnad"')
        self.assert_refused(self.retarget("--ik-config", self.write("config.json", wrong)), 4,
                            "left_kne_link\" (did you mean \"left_knee_link\"?)",
                            "LeftHnad\" (did you mean \"LeftHand\"?)")
        # Errors within the file and errors against the robot are reported together.
        wrong = wrong.replace("[0.5, 0.5, 0.5, 0.5]", "[2, 0, 0, 0]", 1)
        self.assert_refused(self.retarget("--ik-config", self.write("config.json", wrong)), 4,
                            "not a unit quaternion", "left_kne_link")
        heavy = text.replace('["Hips", 100, 5', '["Hips", 1e300, 5')
        self.assert_refused(self.retarget("--ik-config", self.write("config.json", heavy)), 4,
                            "config.json", "not finite")

    def test_robot_folder_without_a_configuration(self):
        self.write("mine/model.xml", (SOURCE / "robots/unitree_g1/model.xml").read_text())
        self.assert_refused(self.retarget(robot="mine"), 4, "no retargeting configuration", "--ik-config")
        self.write("mine/ik.json", (SOURCE / "configs/lafan1_to_unitree_g1.json").read_text())
        self.assertEqual(self.retarget(robot="mine").returncode, 0)


class Devices(ToolTest):
    def test_a_device_that_never_ends(self):
        self.assert_fails(self.retarget(bvh="/dev/zero"), 3, "/dev/zero", "expected a regular file, found a device")
        self.assert_fails(self.retarget("--ik-config", "/dev/zero"), 4, "/dev/zero")


class Outputs(ToolTest):
    @needs_posix
    def test_permissions_are_kept(self):
        out = self.write("out.csv", "old\n")
        out.chmod(0o600)
        self.assert_done(self.retarget())
        self.assertEqual(out.stat().st_mode & 0o777, 0o600)
        if os.geteuid() != 0:
            out.chmod(0o400)
            self.assert_fails(self.retarget(), 1, "out.csv", "ermission")

    @needs_posix
    def test_an_ignored_interrupt_stays_ignored(self):
        ignore = lambda: signal.signal(signal.SIGINT, signal.SIG_IGN)
        process = subprocess.Popen([TOOL, "--bvh", sample("walk"), "--robot", "unitree_g1",
                                    "--fps", "240", "-o", "out.csv"], cwd=self.folder,
                                   stderr=subprocess.PIPE, preexec_fn=ignore)
        for _ in range(10):
            time.sleep(0.02)
            process.send_signal(signal.SIGINT)
        _, message = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 0, message)

    def test_full_disk(self):
        self.assert_fails(self.retarget(output="/dev/full"), 1, "/dev/full", "No space left")
        with open("/dev/full", "wb") as full:
            for words in (("--version",), ("--help",), ("batch", "--help-all"),
                          (sample("wave"), "g1", "--frames", "0:3", "--method", "gmr", "-o", "-")):
                done = subprocess.run([TOOL, *map(str, words)], stdout=full, stderr=subprocess.PIPE,
                                      text=True, timeout=60)
                self.assertEqual(done.returncode, 1, words)
                self.assertIn("standard output: error: cannot write the file: No space left", done.stderr)
                self.assertNotIn("partial", done.stderr)

    @needs_posix
    def test_closed_standard_streams(self):
        def run(streams, *words):
            call = shlex.join([TOOL, *map(str, words)])
            return subprocess.run(f"{call} {streams}", shell=True, cwd=self.folder, text=True,
                                  capture_output=True, timeout=120)

        clip = self.write("wave.bvh", short_clip("wave", 20))
        self.assert_done(run(">frames", "live", "--play", clip, "--to", "stdout", "--speed", "0"))
        for streams, words in (("<&- >&- 2>&-", (clip, "g1")),
                               ("<&- >&- 2>&-", (clip, "g1", "--format", "pkl-gmr")),
                               ("<frames >&- 2>&-", ("live", "--robot", "g1"))):
            self.assert_done(run("<frames", *words, "-o", "whole"))
            self.assert_done(run(streams, *words, "-o", "closed"))
            self.assertEqual((self.folder / "closed").read_bytes(),
                             (self.folder / "whole").read_bytes(), words)
        for words in ((clip, "g1", "-o", "-"), ("--version",), ("inspect", clip)):
            self.assert_fails(run(">&-", *words), 1, "standard output: error: cannot write the file")
        self.assert_fails(run("<&-", "-", "g1", "-o", "x.csv"), 3, "standard input: error: cannot read")

    @needs_posix
    def test_file_size_limit(self):
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
        result = self.retarget(preexec_fn=limit)
        self.assert_fails(result, 1, "out.csv", "File too large")
        self.assertEqual(self.files(), [])

    @needs_posix
    def test_failed_write_keeps_the_old_file(self):
        old = self.write("out.csv", "old\n")
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
        self.assert_fails(self.retarget(preexec_fn=limit), 1)
        self.assertEqual(old.read_text(), "old\n")

    def test_failed_run_keeps_the_old_file(self):
        old = self.write("out.csv", "old\n")
        self.assert_fails(self.retarget(bvh="missing.bvh"), 3)
        self.assertEqual(old.read_text(), "old\n")

    def test_closed_pipe(self):
        with subprocess.Popen([TOOL, "--bvh", sample("walk"), "--robot", "unitree_g1", "-o", "-"],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            process.stdout.close()
            self.assertEqual(process.wait(timeout=120), 1)
            self.assertIn(b"error:", process.stderr.read())

    def test_output_folder(self):
        (self.folder / "folder").mkdir()
        self.assert_fails(self.retarget(output="folder"), 2, "folder")

    @needs_posix
    def test_an_interrupt_leaves_no_files(self):
        # Long enough to be still running when the signal arrives.
        head, rows = sample("wave").read_text().split("Frame Time:", 1)
        time_line, rows = rows.split("\n", 1)
        count = rows.count("\n")
        head = head.replace(f"Frames: {count}", f"Frames: {100 * count}")
        clip = self.write("long.bvh", f"{head}Frame Time:{time_line}\n{100 * rows}")
        for wait in (0.02, 0.8):
            process = subprocess.Popen(
                [TOOL, "--bvh", clip, "--robot", "unitree_g1", "--engine", "reference",
                 "-o", "out.csv"],
                cwd=self.folder, stderr=subprocess.PIPE, preexec_fn=heed_interrupts)
            time.sleep(wait)
            process.send_signal(signal.SIGINT)
            _, message = process.communicate(timeout=60)
            # Before the solve, the signal ends the process itself, which shells report as 130.
            self.assertIn(process.returncode, (130, -signal.SIGINT), message)
            self.assertEqual(self.files(), ["long.bvh"])


def heed_interrupts():
    """Restores SIGINT: a shell ignores it for background jobs, and children inherit that."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


if __name__ == "__main__":
    unittest.main()
