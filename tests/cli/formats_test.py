"""Files of robot motions: written, converted, compared; loaded by Python as docs/formats.md says."""

import io
import json
import os
import pathlib
import pickle
import shutil
import subprocess
import sys
import unittest

import tool
from tool import SOURCE, ToolTest, difference, read_rows, sample

try:
    import numpy as np
except ImportError:
    np = None

SHARED = pathlib.Path(os.environ.get("RETARGET_SHARED", SOURCE.parent / "shared"))
GOLDEN = SOURCE / "tests" / "golden"
G1 = SOURCE / "robots" / "unitree_g1"
FORMATS = {"csv": "out.csv", "csv-soma": "out.soma.csv", "npz-mjlab": "out.mjlab.npz",
           "npz-beyondmimic": "out.beyondmimic.npz", "pkl-gmr": "out.gmr.pkl",
           "pkl-pbhc": "out.pbhc.pkl"}
# Isaac Lab's order of the G1's joints, without "_joint"
BREADTH_FIRST = """left_hip_pitch right_hip_pitch waist_yaw left_hip_roll right_hip_roll waist_roll
    left_hip_yaw right_hip_yaw waist_pitch left_knee right_knee left_shoulder_pitch
    right_shoulder_pitch left_ankle_pitch right_ankle_pitch left_shoulder_roll right_shoulder_roll
    left_ankle_roll right_ankle_roll left_shoulder_yaw right_shoulder_yaw left_elbow right_elbow
    left_wrist_roll right_wrist_roll left_wrist_pitch right_wrist_pitch left_wrist_yaw
    right_wrist_yaw""".split()


def python_with(modules, variable):
    for python in (os.environ.get(variable), sys.executable, "python3"):
        if python and shutil.which(python) and subprocess.run(
                [python, "-c", f"import {modules}"], stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL).returncode == 0:
            return python
    return None


class FormatsTest(ToolTest):
    def setUp(self):
        super().setUp()
        if np is None:
            self.skipTest("no numpy")

    def convert(self, source, output, *arguments, robot="unitree_g1"):
        return self.run_tool("convert", source, output, "--robot", robot, *arguments)

    def converted(self, source, output, *arguments):
        result = self.convert(source, output, *arguments)
        self.assert_done(result)
        return result.stderr

    def load(self, name):
        with open(self.folder / name, "rb") as file:
            return pickle.load(file)

    def rows(self, name):
        return read_rows((self.folder / name).read_text())

    def assert_same(self, found, expected, tolerance):
        self.assertIsNone(difference(found, expected, tolerance))


class Outputs(FormatsTest):
    def test_all_formats_at_once(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:40", "--format",
                                       ",".join(FORMATS), output="out"))
        self.assertEqual(self.files(), sorted(FORMATS.values()))
        # an ending after -o is left out
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:40", "--format", "csv",
                                       "--format", "pkl-gmr", output="again.csv"))
        self.assertEqual((self.folder / "again.csv").read_bytes(),
                         (self.folder / "out.csv").read_bytes())
        self.assertEqual((self.folder / "again.gmr.pkl").read_bytes(),
                         (self.folder / "out.gmr.pkl").read_bytes())

    def test_names_that_do_not_tell_the_format(self):
        self.assert_fails(self.retarget(output="x.npz"), 2, "npz-mjlab, npz-beyondmimic")
        self.assert_fails(self.retarget(output="x.pkl"), 2, "pkl-gmr, pkl-pbhc")
        self.assert_fails(self.retarget("--format", "npz-mjlab", output="x.csv"), 2, "ends in .csv")
        self.assert_fails(self.retarget("--format", "csv,csv", output="x"), 2, "twice")
        self.assert_fails(self.retarget("--format", "csv,pkl-gmr", output="-"), 2,
                          "standard output")
        self.assert_fails(self.retarget("--format", "csv", "--report", "x.csv", output="x.csv"), 2,
                          "two outputs")
        self.assertEqual(self.files(), [])

    def test_all_appear_or_none(self):
        # a clip of two frames has no tracking NPZ
        result = self.retarget("--method", "gmr", "--frames", "0:2", "--format", "csv,npz-mjlab",
                               output="x")
        self.assert_fails(result, 3, "three frames")
        self.assertEqual(self.files(), [])

    def test_the_same_bytes_again(self):
        for name in ("a", "b"):
            self.converted(GOLDEN / "walk.csv", name, "--format", ",".join(FORMATS),
                           "--motion-name", "walk")
        for name in FORMATS.values():
            self.assertEqual((self.folder / name.replace("out", "a")).read_bytes(),
                             (self.folder / name.replace("out", "b")).read_bytes(), name)


class Dictionaries(FormatsTest):
    def setUp(self):
        super().setUp()
        self.csv = np.loadtxt(GOLDEN / "walk.csv", delimiter=",")
        self.stderr = self.converted(GOLDEN / "walk.csv", "out", "--format", "pkl-gmr,pkl-pbhc")

    def test_gmr(self):
        motion = self.load("out.gmr.pkl")
        self.assertEqual(sorted(motion), ["dof_pos", "fps", "link_body_list", "local_body_pos",
                                          "root_pos", "root_rot"])
        self.assertEqual(motion["fps"], 30)
        for key, columns in (("root_pos", slice(0, 3)), ("root_rot", slice(3, 7)),
                             ("dof_pos", slice(7, 36))):
            self.assertEqual(motion[key].dtype, np.float64)
            self.assertLess(np.abs(motion[key] - self.csv[:, columns]).max(), 1e-8, key)
            motion[key] += 0  # may be written to
        bodies = motion["link_body_list"]
        self.assertEqual(bodies[0], "pelvis")
        self.assertEqual(motion["local_body_pos"].shape, (len(self.csv), len(bodies), 3))
        self.assertEqual(np.abs(motion["local_body_pos"][:, 0]).max(), 0)

    def test_pbhc(self):
        self.check_pbhc(self.load("out.pbhc.pkl"))

    def test_pbhc_by_joblib(self):
        try:
            import joblib
        except ImportError:
            self.skipTest("no joblib")
        self.check_pbhc(joblib.load(self.folder / "out.pbhc.pkl"))

    def check_pbhc(self, motions):
        self.assertEqual(list(motions), ["out"])
        motion = motions["out"]
        dof = np.delete(self.csv[:, 7:], [19, 20, 21, 26, 27, 28], axis=1)
        self.assertLess(np.abs(motion["dof"] - dof).max(), 1e-6)
        self.assertEqual(motion["pose_aa"].shape, (len(self.csv), 27, 3))
        # each joint turns about one axis; the last three rows are nobody's
        self.assertLess(np.abs(motion["pose_aa"][:, 1:24].sum(-1) - dof).max(), 1e-6)
        self.assertEqual(np.abs(motion["pose_aa"][:, 24:]).max(), 0)
        self.assertLess(np.abs(motion["root_trans_offset"] - self.csv[:, :3]).max(), 1e-6)
        self.assertLess(np.abs(motion["root_rot"] - self.csv[:, 3:7]).max(), 1e-6)
        self.assertEqual(motion["fps"], 30)


class Documentation(FormatsTest):
    def test_the_lines_that_load_each_format(self):
        self.converted(GOLDEN / "walk.csv", "walk", "--format", ",".join(FORMATS))
        text = (SOURCE / "docs" / "formats.md").read_text()
        blocks = [[]]
        for line in text.splitlines():
            if line.startswith("    "):
                blocks[-1].append(line[4:])
            elif blocks[-1]:
                blocks.append([])
        programs = [block for block in blocks if block and block[0].startswith("import")]
        self.assertEqual(len(programs), 5)
        here = os.getcwd()
        self.addCleanup(os.chdir, here)
        os.chdir(self.folder)
        frames = len(self.rows("walk.csv"))
        for program in programs:
            names = {}
            exec("\n".join(program), names)
            found = [names[name] for name in ("joints", "knee", "height") if name in names]
            self.assertTrue(found and len(found[-1]) in (frames, -(-(frames - 1) * 5 // 3)))


class Tracking(FormatsTest):
    def test_arrays(self):
        self.converted(GOLDEN / "walk.csv", "out", "--format", "npz-mjlab,npz-beyondmimic")
        frames = len((GOLDEN / "walk.csv").read_text().splitlines())
        count = -(-(frames - 1) * 5 // 3)
        for flavour in ("mjlab", "beyondmimic"):
            motion = np.load(self.folder / f"out.{flavour}.npz")
            shapes = {"fps": (1,), "joint_pos": (count, 29), "joint_vel": (count, 29),
                      "body_pos_w": (count, 30, 3), "body_quat_w": (count, 30, 4),
                      "body_lin_vel_w": (count, 30, 3), "body_ang_vel_w": (count, 30, 3)}
            for key, shape in shapes.items():
                self.assertEqual(motion[key].shape, shape, key)
                self.assertEqual(motion[key].dtype, np.int64 if key == "fps" else np.float32, key)
            self.assertEqual(motion["fps"][0], 50)
            self.assertEqual(str(motion["flavour"]), f"npz-{flavour}")
            self.assertEqual(motion["body_names"][0], "pelvis")
        joints = [name.removesuffix("_joint") for name in motion["joint_names"]]
        self.assertEqual(joints, BREADTH_FIRST)
        # bodies follow the joints that move them
        self.assertEqual(list(motion["body_names"][1:4]),
                         ["left_hip_pitch_link", "right_hip_pitch_link", "waist_yaw_link"])

    def test_against_mujoco(self):
        python = python_with("mujoco, numpy", "RETARGET_JUDGE_PYTHON")
        if python is None:
            self.skipTest("no Python with mujoco and numpy: set RETARGET_JUDGE_PYTHON")
        for clip in ("walk", "get_up", "turn_in_place"):
            self.converted(GOLDEN / f"{clip}.csv", "out", "--format", "npz-mjlab,npz-beyondmimic")
            for flavour in ("mjlab", "beyondmimic"):
                result = subprocess.run(
                    [python, SOURCE / "tests" / "cli" / "tracking_reference.py", G1 / "model.xml",
                     GOLDEN / f"{clip}.csv", "30", self.folder / f"out.{flavour}.npz"],
                    text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                self.assertEqual(result.returncode, 0, result.stderr)
                found = json.loads(result.stdout)
                for key, tolerance in (("joint_pos", 1e-6), ("joint_vel", 1e-4),
                                       ("body_pos_w", 1e-5), ("body_quat_w", 1e-6),
                                       ("body_lin_vel_w", 1e-4), ("body_ang_vel_w", 1e-4)):
                    self.assertLess(found[key], tolerance, f"{clip} {flavour} {found}")

    def test_loaded_by_mjlab(self):
        python = python_with("mjlab.tasks.tracking.mdp.commands", "RETARGET_MJLAB_PYTHON")
        if python is None:
            self.skipTest("no Python with mjlab: set RETARGET_MJLAB_PYTHON")
        self.converted(GOLDEN / "walk.csv", "out.npz", "--format", "npz-mjlab")
        code = """
import sys, numpy, torch
from mjlab.tasks.tracking.mdp.commands import MotionLoader
motion = MotionLoader(sys.argv[1], torch.tensor([0, 15]), device="cpu")
arrays = numpy.load(sys.argv[1])
assert motion.time_step_total == len(arrays["joint_pos"])
for key in ("body_pos_w", "body_quat_w", "body_lin_vel_w", "body_ang_vel_w"):
    assert torch.equal(getattr(motion, key), torch.tensor(arrays[key][:, [0, 15]])), key
print("loaded", motion.time_step_total)
"""
        result = subprocess.run([python, "-c", code, self.folder / "out.npz"], text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertIn("loaded", result.stdout, result.stderr)


class Conversions(FormatsTest):
    def test_there_and_back(self):
        golden = read_rows((GOLDEN / "walk.csv").read_text())
        self.converted(GOLDEN / "walk.csv", "out", "--format", "csv,csv-soma,pkl-gmr",
                       "--precision", "9")
        for name in ("out.csv", "out.soma.csv", "out.gmr.pkl"):
            self.converted(name, "back.csv", "--precision", "9")
            self.assert_same(self.rows("back.csv"), golden, 2e-9)
        # both trackers' files are known for what they are and hold the same motion
        self.converted(GOLDEN / "walk.csv", "out", "--format", "npz-mjlab,npz-beyondmimic")
        for flavour in ("mjlab", "beyondmimic"):
            said = self.converted(f"out.{flavour}.npz", f"{flavour}.csv")
            self.assertIn(f"npz-{flavour}, ", said)
            self.assertIn("at 50 fps", said)
        self.assertEqual((self.folder / "mjlab.csv").read_bytes(),
                         (self.folder / "beyondmimic.csv").read_bytes())

    def test_csv_dialects_are_found(self):
        golden = read_rows((GOLDEN / "walk.csv").read_text())
        dialects = {
            "wxyz": ("--csv-quat", "wxyz"),
            "space": ("--csv-delimiter", "space"),
            "numbered": ("--csv-frame-column", "--csv-delimiter", "tab"),
            "named": ("--csv-header", "--csv-quat", "wxyz", "--csv-frame-column"),
        }
        for name, options in dialects.items():
            self.converted(GOLDEN / "walk.csv", f"{name}.csv", "--precision", "9", *options)
            said = self.converted(f"{name}.csv", "back.csv", "--precision", "9")
            self.assert_same(self.rows("back.csv"), golden, 1e-8)
        self.assertIn("frame numbers", said)
        said = self.converted("wxyz.csv", "back.csv")
        self.assertIn("quaternion wxyz", said)

    def test_units_that_a_csv_does_not_name_are_never_guessed(self):
        golden = read_rows((GOLDEN / "walk.csv").read_text())
        self.converted(GOLDEN / "walk.csv", "other.csv", "--precision", "9", "--csv-degrees",
                       "--csv-centimetres")
        self.assert_fails(self.convert("other.csv", "x.csv"), 3, "--source-angles")
        degrees = ("--source-angles", "deg")
        self.assert_fails(self.convert("other.csv", "x.csv", *degrees), 3, "--source-unit")
        self.converted("other.csv", "back.csv", *degrees, "--source-unit", "cm", "--precision", "9")
        self.assert_same(self.rows("back.csv"), golden, 1e-8)
        # a walk on a roof, which was written back on the ground, a hundredth of its size
        high = np.array(golden)
        high[:, 2] += 7.0
        np.savetxt(self.folder / "high.csv", high, delimiter=",")
        for command in (("convert", "high.csv", "x.csv"), ("evaluate", "high.csv")):
            self.assert_fails(self.run_tool(*command, "--robot", "unitree_g1"), 3, "--source-unit")
        self.assertFalse((self.folder / "x.csv").exists())
        self.converted("high.csv", "x.csv", "--source-unit", "m")
        self.assert_same(self.rows("x.csv"), high.tolist(), 1e-6)

    def test_what_cannot_be_told_is_asked(self):
        rows = np.loadtxt(GOLDEN / "walk.csv", delimiter=",")
        odd = rows.copy()
        odd[:, 10] = 5.0
        np.savetxt(self.folder / "odd.csv", odd, delimiter=",")
        self.assert_fails(self.convert("odd.csv", "x.csv"), 3, "--source-angles")
        high = rows.copy()
        high[:, 2] += 4.0
        np.savetxt(self.folder / "high.csv", high, delimiter=",")
        self.assert_fails(self.convert("high.csv", "x.csv"), 3, "--source-unit")
        self.converted("high.csv", "x.csv", "--source-unit", "m")
        # 23 columns are those of two variants
        np.savetxt(self.folder / "few.csv", rows[:, :30], delimiter=",")
        self.assert_fails(self.convert("few.csv", "x.csv"), 3, "--source-dof", "23, 23-pbhc")
        # a robot that lies still
        lying = np.repeat(rows[:1], 20, axis=0)
        lying[:, 3:7] = [0.5, 0.5, 0.5, 0.5]
        np.savetxt(self.folder / "lying.csv", lying, delimiter=",")
        self.assert_fails(self.convert("lying.csv", "x.csv"), 3, "--source-quat")
        np.savetxt(self.folder / "crooked.csv", 2 * rows, delimiter=",")
        self.assert_fails(self.convert("crooked.csv", "y.csv"), 3, "should have 1")
        self.assertFalse((self.folder / "y.csv").exists())

    def test_variants(self):
        said = self.converted(GOLDEN / "walk.csv", "few.csv", "--dof", "23-pbhc", "--precision", "9")
        self.assertIn("held and lost", said)
        self.assertEqual(len(self.rows("few.csv")[0]), 30)
        self.converted("few.csv", "all.csv", "--source-dof", "23-pbhc", "--precision", "9")
        wanted = np.loadtxt(GOLDEN / "walk.csv", delimiter=",")
        wanted[:, [26, 27, 28, 33, 34, 35]] = 0
        self.assert_same(self.rows("all.csv"), wanted.tolist(), 1e-9)

    def test_rates(self):
        frames = np.arange(61)
        rows = np.loadtxt(GOLDEN / "walk.csv", delimiter=",")[:1].repeat(61, axis=0)
        rows[:, 0] = 0.01 * frames + 1e-5 * frames ** 2
        rows[:, 10] = np.sin(0.05 * frames)
        np.savetxt(self.folder / "a.csv", rows, delimiter=",")
        self.converted("a.csv", "b.csv", "--source-fps", "120", "--fps", "60", "--no-antialias",
                       "--source-quat", "xyzw", "--precision", "9")
        self.assert_same(self.rows("b.csv"), rows[::2].tolist(), 1e-8)
        self.converted("a.csv", "c.csv", "--source-fps", "60", "--fps", "120", "--source-quat", "xyzw",
                       "--precision", "9")
        fine = np.arange(0, 60.1, 0.5)
        found = np.array(self.rows("c.csv"))
        self.assertEqual(len(found), 121)
        self.assertLess(np.abs(found[:, 0] - (0.01 * fine + 1e-5 * fine ** 2)).max(), 1e-8)
        self.assertLess(np.abs(found[:, 10] - np.sin(0.05 * fine)).max(), 1e-6)
        # a column of times has the rate
        timed = np.column_stack([frames / 120, rows])
        np.savetxt(self.folder / "timed.csv", timed, delimiter=",", fmt="%.9f")
        self.assertIn("at 120 fps", self.converted("timed.csv", "d.csv", "--source-quat",
                                                        "xyzw"))

    def test_python_pickles_of_every_protocol(self):
        rows = np.loadtxt(GOLDEN / "walk.csv", delimiter=",")
        for protocol in (2, 3, 4, 5):
            for order in ("C", "F"):
                motion = {"fps": np.float64(30), "root_pos": rows[:, :3].astype(">f4"),
                          "root_rot": np.array(rows[:, 3:7], order=order),
                          "dof_pos": np.array(rows[:, 7:], order=order), "local_body_pos": None,
                          "link_body_list": None}
                with open(self.folder / "a.pkl", "wb") as file:
                    pickle.dump(motion, file, protocol)
                self.converted("a.pkl", "b.csv", "--precision", "9")
                self.assert_same(self.rows("b.csv"), rows.tolist(), 1e-6)

    def test_pickles_of_joblib(self):
        try:
            import joblib
        except ImportError:
            self.skipTest("no joblib")
        rows = np.loadtxt(GOLDEN / "walk.csv", delimiter=",")
        dof = np.delete(rows[:, 7:], [19, 20, 21, 26, 27, 28], axis=1)
        motion = {"root_trans_offset": rows[:, :3], "root_rot": rows[:, 3:7],
                  "dof": np.asfortranarray(dof), "fps": 30}
        for compress in (0, 3, ("gzip", 3)):
            joblib.dump({"a": motion, "b": motion}, self.folder / "a.pkl", compress=compress)
            self.assert_fails(self.convert("a.pkl", "b.csv"), 3, "--motion: a, b")
            self.converted("a.pkl", "b.csv", "--motion", "b", "--precision", "9")
            wanted = rows.copy()
            wanted[:, [26, 27, 28, 33, 34, 35]] = 0
            self.assert_same(self.rows("b.csv"), wanted.tolist(), 1e-8)

    def test_nothing_is_executed(self):
        class Evil:
            def __reduce__(self):
                return os.system, (f"touch {self_folder}/executed",)

        self_folder = self.folder
        for protocol in (2, 4):
            self.write("evil.pkl", pickle.dumps({"fps": 30, "root_pos": Evil()}, protocol))
            self.assert_fails(self.convert("evil.pkl", "x.csv"), 3, "system, which is refused")
        self.assertEqual(self.files(), ["evil.pkl"])

    def test_other_files_are_named(self):
        self.assert_fails(self.convert(tool.sample("walk"), "x.csv"), 3, "BVH", "retarget --bvh")
        np.savez(self.folder / "a.npz", poses=np.zeros((3, 156)))
        self.assert_fails(self.convert("a.npz", "x.csv"), 3, "no array \"joint_pos\"")
        self.write("empty.csv", "")
        self.assert_fails(self.convert("empty.csv", "x.csv"), 3, "no frames")


class Lengths(ToolTest):
    def test_a_walk_on_the_ground_is_not_in_metres(self):
        """A hundredth, a tenth and a thousandth of a walk were written without a word."""
        self.assert_done(self.retarget("--frames", "0:90", bvh=sample("walk")))
        rows = read_rows((self.folder / "out.csv").read_text())
        for scale in (0.1, 0.01, 0.001):
            small = [[scale * value for value in row[:3]] + row[3:] for row in rows]
            self.write("small.csv", "".join(",".join(f"{v:.6f}" for v in row) + "\n"
                                            for row in small))
            for command in (("convert", "small.csv", "x.csv"), ("evaluate", "small.csv")):
                line = (*command, "--robot", "g1", "--source-quat", "xyzw")
                self.assert_fails(self.run_tool(*line), 3, "upright", "--source-unit m")
        self.assertFalse((self.folder / "x.csv").exists())
        self.assert_done(self.run_tool("convert", "small.csv", "x.csv", "--robot", "g1",
                                       "--source-quat", "xyzw", "--source-unit", "m"))

    def test_bodies_on_the_ground_are_in_metres(self):
        for name in ("get_up", "squat"):
            self.assert_done(self.retarget(bvh=sample(name), output="own.csv"))
            result = self.run_tool("convert", "own.csv", "x.csv", "--robot", "g1")
            self.assert_done(result)
            self.assertNotIn("warning", result.stderr)


class RealFiles(FormatsTest):
    """Files that others made."""

    def setUp(self):
        super().setUp()
        self.data = SHARED / "data" / "robot_motion"
        if not self.data.exists():
            self.skipTest("no folder of shared data: set RETARGET_SHARED to run this test")

    def test_gmr(self):
        self.converted(self.data / "gmr_g1_soma_walk_forward.pkl", "a.csv", "--precision", "12")
        with open(self.data / "gmr_g1_soma_walk_forward.pkl", "rb") as file:
            motion = pickle.load(file)
        wanted = np.hstack([motion["root_pos"], motion["root_rot"], motion["dof_pos"]])
        found = np.array(self.rows("a.csv"))
        found[:, 3:7] *= np.sign((found[:, 3:7] * wanted[:, 3:7]).sum(1, keepdims=True))
        self.assertLess(np.abs(found - wanted).max(), 1e-9)
        # its true rate is another one
        said = self.converted(self.data / "gmr_g1_soma_walk_forward.pkl", "b.csv", "--source-fps",
                              "120", "--fps", "30")
        self.assertIn("273 frames at 30 fps", said)

    def test_pbhc_and_asap(self):
        for name, frames in (("pbhc_g1_23dof_horse_stance_punch", 200), ("asap_g1_walk_joblib", 152)):
            self.converted(self.data / f"{name}.pkl", f"{name}.csv")
            found = np.array(self.rows(f"{name}.csv"))
            self.assertEqual(found.shape, (frames, 36))
            self.assertEqual(np.abs(found[:, [26, 27, 28, 33, 34, 35]]).max(), 0)
            self.assertGreater(np.abs(found[:, 7:26]).max(), 0.3)
            # and back
            self.converted(f"{name}.csv", f"{name}.pkl", "--format", "pkl-pbhc")
            self.converted(f"{name}.pkl", "again.csv")
            self.assert_same(self.rows("again.csv"), found.tolist(), 2e-6)

    def test_unitree(self):
        for clip in ("walk4_subject1", "dance1_subject2", "fallAndGetUp2_subject2"):
            rows = np.loadtxt(SHARED / "data" / "unitree_g1_csv" / f"{clip}.csv", delimiter=",")[:900]
            np.savetxt(self.folder / "a.csv", rows, delimiter=",", fmt="%.6f")
            rows[:, 3:7] = rows[:, [6, 3, 4, 5]]
            np.savetxt(self.folder / "b.csv", rows, delimiter=",", fmt="%.6f")
            self.assertIn("quaternion xyzw", self.converted("a.csv", "c.csv"), clip)
            self.assertIn("quaternion wxyz", self.converted("b.csv", "d.csv"), clip)
            self.assertEqual((self.folder / "c.csv").read_bytes(),
                             (self.folder / "d.csv").read_bytes())


class Comparing(FormatsTest):
    def compare(self, *arguments):
        return self.run_tool("compare", *arguments)

    def test_agreement(self):
        golden = GOLDEN / "walk.csv"
        self.assert_done(self.compare(golden, golden))
        rows = np.loadtxt(golden, delimiter=",")
        rows[10:, 3:7] *= -1  # the same rotation
        np.savetxt(self.folder / "a.csv", rows, delimiter=",")
        self.assert_done(self.compare(golden, "a.csv"))
        rows[5:8, 12] += 1e-3
        np.savetxt(self.folder / "b.csv", rows, delimiter=",")
        result = self.compare(golden, "b.csv")
        self.assert_fails(result, 1, "differ in 1 column", "column 13", "0.001 in frame")
        self.assertIn("in 3 frames, first in 5", result.stderr)
        self.assert_done(self.compare(golden, "b.csv", "--tolerance", "0.01"))
        np.savetxt(self.folder / "c.csv", rows[:-1], delimiter=",")
        self.assert_fails(self.compare("b.csv", "c.csv"), 1, f"b.csv has {len(rows)} frames")
        self.assert_fails(self.compare(golden, SOURCE / "robots"), 3, "Is a directory")

    def test_across_formats(self):
        golden = GOLDEN / "walk.csv"
        self.converted(golden, "out", "--format", ",".join(FORMATS))
        for name in ("out.soma.csv", "out.gmr.pkl"):
            self.assert_done(self.compare(golden, self.folder / name, "--robot", "unitree_g1",
                                          "--tolerance", "1e-5"))
        for name in ("out.mjlab.npz", "out.gmr.pkl", "out.pbhc.pkl"):
            self.assert_done(self.compare(name, name))
        self.assert_fails(self.compare(golden, "out.gmr.pkl"), 3, "--robot")
        self.assert_fails(self.compare("out.mjlab.npz", "out.beyondmimic.npz"), 1, "differ in")
        self.assert_done(self.compare("out.mjlab.npz", "out.beyondmimic.npz", "--robot",
                                      "unitree_g1"))


class Evaluating(FormatsTest):
    def test_every_format_is_measured(self):
        self.converted(GOLDEN / "walk.csv", "out", "--format", ",".join(FORMATS))
        figures = {}
        for name in FORMATS.values():
            self.assert_done(self.run_tool("evaluate", name, "--robot", "unitree_g1", "--gate",
                                           "none", "--json", "report.json"))
            report = json.loads((self.folder / "report.json").read_text())
            motion = report["motions"][0] if "motions" in report else report
            figures[name] = motion["frames"], motion["fps"]
        self.assertEqual(figures["out.csv"], (301, 30))
        self.assertEqual(figures["out.gmr.pkl"], (301, 30))
        self.assertEqual(figures["out.mjlab.npz"], (500, 50))
        self.assertEqual(figures["out.soma.csv"], (301, 30))


class Provenance(FormatsTest):
    def setUp(self):
        super().setUp()
        shutil.copy(tool.sample("wave"), self.folder / "in.bvh")

    def verify(self, name="out.csv.json", **options):
        return self.run_tool("verify", name, **options)

    def test_sidecar(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:60", "--sidecar",
                                       "--format", "csv,npz-mjlab", bvh="in.bvh", output="out"))
        self.assertEqual(self.files(), ["in.bvh", "out.csv", "out.csv.json", "out.mjlab.npz",
                                        "out.mjlab.npz.json"])
        sidecar = json.loads((self.folder / "out.csv.json").read_text())
        self.assertEqual(sidecar["output"]["format"], "csv")
        self.assertEqual(sidecar["options"]["method"], "gmr")
        self.assertEqual(sidecar["options"]["frames"], "0:60")
        roles = [each["role"] for each in sidecar["inputs"]]
        self.assertEqual(roles, ["motion", "model", "profile", "mapping", "skeletons"])
        self.assertTrue(all(each["hash"].startswith("sha256:") for each in sidecar["inputs"]))
        self.assertEqual(sidecar["found"]["unit"], "cm")
        self.assertIn("metrics", json.dumps(sidecar["quality"]))
        self.assert_done(self.verify())
        self.assert_done(self.verify("out.mjlab.npz.json"))
        # nothing was written
        self.assertEqual(len(self.files()), 5)

    def test_what_changed_is_named(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:40", "--sidecar",
                                       bvh="in.bvh"))
        bvh = (self.folder / "in.bvh").read_text()
        # as moved to another folder
        moved = self.folder / "moved"
        moved.mkdir()
        for name in ("in.bvh", "out.csv", "out.csv.json"):
            shutil.copy(self.folder / name, moved / name)
        (self.folder / "in.bvh").unlink()
        self.assert_done(self.verify(moved / "out.csv.json"))
        lines = bvh.splitlines(keepends=True)
        row = lines[-390].split() if len(lines) > 400 else lines[-1].split()
        first = next(i for i, line in enumerate(lines) if line.startswith("Frame Time")) + 6
        row = lines[first].split()
        row[1] = str(float(row[1]) + 1.0)
        lines[first] = " ".join(row) + "\n"
        self.write("in.bvh", "".join(lines))
        result = self.verify()
        self.assert_fails(result, 1, "the output differs", "the motion in.bvh has changed")
        self.write("in.bvh", bvh)
        self.assert_done(self.verify())
        csv = (self.folder / "out.csv").read_text()
        self.write("out.csv", csv + csv.splitlines()[-1] + "\n")
        self.assert_fails(self.verify(), 1, "changed since the sidecar was written")
        self.assert_fails(self.verify("in.bvh"), 3, "not the sidecar of a run")

    def test_an_output_beside_the_sidecar_alone(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:2", "--sidecar",
                                       bvh="in.bvh"))
        sidecar = json.loads((self.folder / "out.csv.json").read_text())
        for name in ("../out.csv", str(self.folder / "out.csv"), "a/out.csv", ".."):
            sidecar["output"]["file"] = name
            self.write("odd.json", json.dumps(sidecar))
            self.assert_fails(self.verify("odd.json"), 3, "not the name of a file beside it")

    def test_a_sidecar_of_many_members_is_refused_at_once(self):
        sidecar = {"output": {"file": "a.csv"}, "options": {}, "inputs": []}
        sidecar.update({f"key{i}": 1 for i in range(200_000)})
        self.write("many.json", json.dumps(sidecar))
        self.assert_fails(self.verify("many.json"), 3, "an object of more than 2000 members")

    def test_standard_output_has_no_sidecar(self):
        self.assert_fails(self.retarget("--sidecar", output="-"), 2, "--sidecar needs an output file")


if __name__ == "__main__":
    unittest.main()
