"""Small files that expand: rejected, or processed in bounded memory and time."""

import io
import os
import subprocess
import unittest
import zipfile

from tool import ToolTest, sample


def joints_without_channels(joints, frames):
    """Returns joints without channels and one joint with a single channel."""
    hierarchy = "HIERARCHY\nROOT a{OFFSET 0 1 0 CHANNELS 1 Xrotation\n"
    hierarchy += "".join(f"JOINT j{i}{{OFFSET 0 0 0}}" for i in range(joints)) + "}\n"
    return hierarchy + f"MOTION\nFrames: {frames}\nFrame Time: 0.01\n" + "0\n" * frames


def zeros(shape):
    """Returns a NumPy file of zero bytes."""
    header = f"{{'descr': '|u1', 'fortran_order': False, 'shape': {shape}, }}"
    header += " " * (63 - (10 + len(header)) % 64) + "\n"
    size = 1
    for part in shape:
        size *= part
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode() + bytes(size)


def packed_motion(frames, fps):
    """An SMPL motion of zeros, a few bytes for each thousand numbers."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        archive.writestr("poses.npy", zeros((frames, 66)))
        archive.writestr("trans.npy", zeros((frames, 3)))
        rate = bytearray(zeros((1,)))
        rate[-1] = fps
        archive.writestr("fps.npy", bytes(rate))
    return packed.getvalue()


class HostileInput(ToolTest):
    def test_joints_without_channels(self):
        text = joints_without_channels(2000, 40000)
        self.assertLess(len(text), 135000)
        clip = self.write("clip.bvh", text)
        for command in (("inspect", clip), ("--bvh", clip, "--robot", "unitree_g1", "-o", "o.csv")):
            result = self.run_measured(*command)
            self.assert_small(result)
            self.assertEqual(result.returncode, 3)
            self.assertIn("clip.bvh:", result.stderr)
            self.assertIn("40000 frames of 2001 joints need", " ".join(result.stderr.split()))

    def test_few_numbers_for_many_frames(self):
        def body(joints, indent=0):
            text = ""
            for name, offset, below in joints:
                channels = "" if indent else "CHANNELS 1 Yrotation "
                text += f"{'JOINT' if indent else 'ROOT'} {name}{{OFFSET {offset}\n{channels}"
                text += body(below, indent + 1) + "}\n"
            return text

        def side(name, x):
            arm = [(name + "Arm", f"{12 * x} 0 0", [(name + "ForeArm", f"{28 * x} 0 0", [
                (name + "Hand", f"{25 * x} 0 0", [])])])]
            leg = (name + "UpLeg", f"{9 * x} 0 0", [(name + "Leg", "0 -43 0", [
                (name + "Foot", "0 -42 0", [(name + "ToeBase", "0 -8 14", [])])])])
            return leg, (name + "Shoulder", f"{5 * x} 14 0", arm)

        left, right = side("Left", 1), side("Right", -1)
        chest = ("Spine1", "0 12 0", [("Spine2", "0 12 0", [
            ("Neck", "0 18 0", [("Head", "0 10 0", [])]), left[1], right[1]])])
        hips = ("Hips", "0 95 0", [left[0], right[0], ("Spine", "0 10 0", [chest])])
        for frames, seconds in ((47000, 0.125), (47000, 1), (47000, 30), (1000, 30)):
            clip = self.write("clip.bvh", "HIERARCHY\n" + body([hips]) +
                              f"MOTION\nFrames: {frames}\nFrame Time: {seconds}\n" + "0\n" * frames)
            self.assertLess(clip.stat().st_size, 100000)
            result = self.run_measured("--bvh", clip, "--robot", "unitree_g1", "-o", "o.csv")
            self.assert_small(result)
            self.assertEqual(result.returncode, 3, result.stderr)
            self.assertIn("frames", result.stderr)
        # The same at a plausible rate is a motion.
        result = self.run_measured("--bvh", clip, "--source-fps", 30, "--robot", "unitree_g1",
                                   "-o", "o.csv")
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_motions_packed_tightly(self):
        for frames, fps in ((480000, 30), (31000, 30), (31000, 8), (31000, 1), (31000, 250)):
            motion = self.write("clip.npz", packed_motion(frames, fps))
            self.assertLess(motion.stat().st_size, 100000)
            self.assert_small(self.run_measured("inspect", motion))
            if frames > 100000 or fps == 1:
                result = self.run_measured("--smpl", motion, "--robot", "unitree_g1",
                                           "--method", "gmr", "-o", "o.csv")
                self.assert_small(result)
                self.assertEqual(result.returncode, 3)

    def test_endless_pipe_ends_at_the_memory(self):
        read, write = os.pipe()
        feeder = subprocess.Popen(["/bin/cat", "/dev/zero"], stdout=write)
        os.close(write)
        try:
            result = self.run_measured("inspect", "-", "--memory", "0.1", stdin=read)
        finally:
            os.close(read)
            feeder.kill()
            feeder.wait()
        self.assert_small(result)
        self.assertEqual(result.returncode, 3)
        self.assertIn("expected at most 25000000 bytes", " ".join(result.stderr.split()))

    def test_memory_bounds_a_run_and_a_batch(self):
        # 60 joints that move, 20,000 frames: 40 MB as a clip
        text = "HIERARCHY\nROOT a{OFFSET 0 1 0 CHANNELS 1 Xrotation\n"
        text += "".join(f"JOINT j{i}{{OFFSET 0 0 0 CHANNELS 1 Xrotation}}" for i in range(59))
        text += "}\nMOTION\nFrames: 20000\nFrame Time: 0.01\n" + ("0 " * 59 + "0\n") * 20000
        clip = self.write("in/clip.bvh", text)
        result = self.run_measured("inspect", clip, "--memory", "0.1")
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn("at most 25 MB are allowed", " ".join(result.stderr.split()))
        self.assertEqual(self.run_measured("inspect", clip, "--memory", "1").returncode, 0)
        result = self.run_measured("batch", "in", "-o", "out", "--robot", "unitree_g1",
                                   "--memory", "0.1")
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("at most 25 MB are allowed",
                      (self.folder / "out" / "manifest.jsonl").read_text())

    def test_json_of_many_keys(self):
        text = "{" + ",".join(f'"k{i}":0' for i in range(200000)) + "}"
        many = self.write("many.json", text)
        for option in ("--ik-config", "--fit-config", "--map"):
            result = self.run_measured("--bvh", sample("wave"), "--robot", "unitree_g1",
                                       option, many, "-o", "o.csv", seconds=10)
            self.assertIn(result.returncode, (3, 4), result.stderr)
            self.assertIn("more than 2000 members", " ".join(result.stderr.split()))

    def test_models_that_end_the_process(self):
        ball = '<body name="b"><freejoint/><geom size="0.1"/></body>'
        pipe = self.folder / "pipe.xml"
        os.mkfifo(pipe)
        for part in ('<size nuser_body="2000000000"/>', '<size nkey="2000000000"/>',
                     '<asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset>',
                     '<worldbody><replicate count="1e9"><geom size="1"/></replicate></worldbody>',
                     '<include file="pipe.xml"/>', '<include file="/dev/zero"/>'):
            model = self.write("robot.xml",
                               f"<mujoco>{part}<worldbody>{ball}</worldbody></mujoco>")
            for command in (("robots", "check", model),
                            ("robots", "add", "mine", "--model", model),
                            ("--bvh", sample("wave"), "--robot-xml", model,
                             "--ik-config", "none.json", "-o", "o.csv")):
                result = self.run_measured(*command, seconds=10)
                self.assert_small(result)
                self.assertNotEqual(result.returncode, 0, part)
                self.assertIn("error:", result.stderr)

    def test_roots_far_away_are_rejected(self):
        lines = sample("wave").read_text().splitlines()
        motion = next(i for i, line in enumerate(lines) if line.startswith("Frame Time"))
        far = [" ".join(["1e18", *line.split()[1:]]) for line in lines[motion + 1:]]
        clip = self.write("far.bvh", "\n".join([*lines[:motion + 1], *far]) + "\n")
        for method in ("gmr", "fit"):
            result = self.retarget("--method", method, "--unit", "cm", bvh=clip)
            self.assert_fails(result, 3, "500 km away")
            self.assertNotIn("out.csv", self.files())


if __name__ == "__main__":
    unittest.main()
