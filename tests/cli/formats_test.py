"""Files of robot motions: written, compared; loaded by Python as docs/formats.md says."""

import json
import os
import shutil
import subprocess
import sys
import unittest

from motion_formats import FORMATS, GOLDEN, FormatsTest
from optional_numpy import numpy as np
from tool import SOURCE, sample

G1 = SOURCE / "robots" / "unitree_g1"
# Isaac Lab's order of the G1's joints, without "_joint".
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


class Outputs(FormatsTest):
    def test_all_formats_at_once(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:40", "--format",
                                       ",".join(FORMATS), output="out"))
        self.assertEqual(self.files(), sorted(FORMATS.values()))
        # An extension of -o is omitted.
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:40", "--format", "csv",
                                       "--format", "pkl-gmr", output="again.csv"))
        self.assertEqual((self.folder / "again.csv").read_bytes(),
                         (self.folder / "out.csv").read_bytes())
        self.assertEqual((self.folder / "again.gmr.pkl").read_bytes(),
                         (self.folder / "out.gmr.pkl").read_bytes())

    def test_ambiguous_names_need_a_format(self):
        self.assert_fails(self.retarget(output="x.npz"), 2, "npz-mjlab, npz-beyondmimic")
        self.assert_fails(self.retarget(output="x.pkl"), 2, "pkl-gmr, pkl-pbhc")
        self.assert_fails(self.retarget("--format", "npz-mjlab", output="x.csv"), 2, "ends in .csv")
        self.assert_fails(self.retarget("--format", "csv,csv", output="x"), 2, "twice")
        self.assert_fails(self.retarget("--format", "csv,pkl-gmr", output="-"), 2,
                          "standard output")
        self.assert_fails(self.retarget("--format", "csv", "--report", "x.csv", output="x.csv"), 2,
                          "two outputs")
        self.assertEqual(self.files(), [])

    def test_options_of_formats_that_are_not_written(self):
        for output, options, users in (
                ("x.csv", ("--npz-fps", "60"), "npz-mjlab"),
                ("x.csv", ("--npz-velocity", "mass"), "csv-sonic"),
                ("x.csv", ("--motion-name", "a"), "pkl-pbhc"),
                ("x.pkl", ("--format", "pkl-gmr", "--csv-header"), "csv"),
                ("x.pkl", ("--format", "pkl-gmr", "--precision", "2"), "csv-soma"),
                ("x.glb", ("--precision", "2"), "csv-soma"),
                ("x.csv", ("--format", "csv-soma", "--csv-quat", "wxyz"), "csv")):
            with self.subTest(options=options):
                result = self.retarget(*options, output=output)
                self.assert_fails(result, 2, "has no effect")
                self.assertIn("it applies to", result.stderr)
                self.assertIn(users, result.stderr)
        self.assertEqual(self.files(), [])
        # Given defaults change nothing, and one of several formats suffices.
        self.converted(GOLDEN / "walk.csv", "x.csv", "--npz-fps", "50")
        self.converted(GOLDEN / "walk.csv", "y", "--format", "csv,pkl-pbhc", "--motion-name", "a")

    def test_the_report_is_that_of_the_printed_numbers(self):
        for name, options in (("a.csv", ("--csv-degrees", "--csv-centimetres", "--csv-header")),
                              ("b.csv", ("--format", "csv-soma"))):
            self.assert_done(self.retarget("--precision", "2", "--sidecar", "--report", "run.json",
                                           *options, bvh=sample("get_up"), output=name))
            self.run_tool("evaluate", name, "--robot", "unitree_g1", "--fps", "30", "--bvh",
                          sample("get_up"), "--json", "file.json")
            run, file = (json.loads((self.folder / report).read_text())["motions"][0]
                         for report in ("run.json", "file.json"))
            gates = [gate for gate in run["gates"] if gate["metric"] != "solver_failures"]
            self.assertEqual(file["gates"], gates, name)
            self.assertEqual(run["limit_pct"], 0)
            self.assert_done(self.run_tool("verify", f"{name}.json"))

    def test_files_beside_a_coarse_csv(self):
        self.assert_done(self.retarget("--precision", "1", "--csv-degrees", "--sidecar", "--format",
                                       "csv,pkl-gmr,npz-mjlab", bvh=sample("squat"), output="out"))
        for name in ("out.csv", "out.gmr.pkl", "out.mjlab.npz"):
            self.assert_done(self.run_tool("verify", f"{name}.json"))

    def test_folders_of_sonic_at_other_rates(self):
        stderr = self.converted(GOLDEN / "walk.csv", "usual", "--format", "csv-sonic")
        self.assertNotIn("assume", stderr)
        stderr = self.converted(GOLDEN / "walk.csv", "fast", "--format", "csv-sonic", "--npz-fps",
                                "120")
        self.assertIn("assume 50 fps, this motion has 120", stderr)

    def test_headers_with_units_on_some_columns(self):
        self.converted(GOLDEN / "walk.csv", "named.csv", "--csv-header")
        self.converted(self.folder / "named.csv", "plain.csv")
        text = (self.folder / "named.csv").read_text()
        for name, unit in (("left_knee_joint", "(deg)"), ("root_x", "(cm)")):
            with self.subTest(name=name):
                self.assertIn(name + ",", text)
                self.write("some.csv", text.replace(name + ",", name + unit + ",", 1))
                self.assert_fails(self.run_tool("convert", "some.csv", "out.csv", "--robot",
                                                "unitree_g1"), 3, "without a unit")
                # The default unit may be named in some columns only.
                usual = {"(deg)": "(rad)", "(cm)": "(m)"}[unit]
                self.write("some.csv", text.replace(name + ",", name + usual + ",", 1))
                self.converted(self.folder / "some.csv", "out.csv")
                self.assertEqual((self.folder / "out.csv").read_bytes(),
                                 (self.folder / "plain.csv").read_bytes())

    def test_all_appear_or_none(self):
        # A clip of two frames has no tracking NPZ.
        result = self.retarget("--method", "gmr", "--frames", "0:2", "--format", "csv,npz-mjlab",
                               output="x")
        self.assert_fails(result, 3, "three frames at 50 fps, but the motion has 2 at 30 fps")
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
            motion[key] += 0  # The array is writable.
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
        # Each joint rotates about one axis; the last three rows belong to no joint.
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
        self.assertEqual(len(programs), 9)
        # Like a batch with a single clip.
        (self.folder / "train").mkdir()
        clip = dict(np.load(self.folder / "walk.mjlab.npz"))
        np.savez(self.folder / "train/motions.npz", **clip, clip_names=["walk"], clip_starts=[0],
                 clip_lengths=[len(clip["joint_pos"])])
        here = os.getcwd()
        self.addCleanup(os.chdir, here)
        os.chdir(self.folder)
        frames = len(self.rows("walk.csv"))
        for program in programs:
            names = {}
            exec("\n".join(program), names)
            found = [names[name] for name in ("joints", "knee", "height") if name in names]
            found = [each["walk"] if isinstance(each, dict) else each for each in found]
            self.assertTrue(found and len(found[-1]) in (frames, -(-(frames - 1) * 5 // 3)))


class Variants(FormatsTest):
    def test_bodies_are_those_of_the_makers_models(self):
        """A run's files; places against MuJoCo's are tests/io/variant_bodies_test.cpp."""
        for dof, joints, bodies in (("29", 29, 30), ("27", 27, 30), ("23", 23, 24)):
            self.assert_done(self.retarget("--frames", "0:40", "--dof", dof, "--format",
                                           "csv,npz-mjlab,npz-beyondmimic,pkl-gmr", output=dof))
            self.assertEqual(len(self.rows(f"{dof}.csv")[0]), 7 + joints)
            self.assertIn("torso_link", self.load(f"{dof}.gmr.pkl")["link_body_list"])
            for flavour in ("mjlab", "beyondmimic"):
                motion = np.load(self.folder / f"{dof}.{flavour}.npz")
                names = list(motion["body_names"])
                self.assertEqual((motion["joint_pos"].shape[1], len(names)), (joints, bodies))
                # The anchor relative to the pelvis, equal in all three models.
                place = {name: motion["body_pos_w"][:, names.index(name)].astype(float)
                         for name in ("pelvis", "torso_link")}
                apart = np.linalg.norm(place["torso_link"] - place["pelvis"], axis=1)
                self.assertLess(np.abs(apart - np.hypot(0.0039635, 0.044)).max(), 1e-5)

    def test_a_motion_of_all_joints_becomes_the_variants(self):
        self.converted(GOLDEN / "walk.csv", "few.csv", "--dof", "23", "--precision", "9")
        self.converted("few.csv", "all.csv", "--source-dof", "23", "--precision", "9")
        wanted = np.loadtxt(GOLDEN / "walk.csv", delimiter=",")
        wanted[:, [20, 21, 27, 28, 34, 35]] = 0
        self.assert_same(self.rows("all.csv"), wanted.tolist(), 1e-9)
        self.converted(GOLDEN / "walk.csv", "few.npz", "--dof", "23", "--format", "npz-mjlab")
        said = self.converted("few.npz", "again.csv", "--dof", "23", "--fps", "30")
        self.assertIn("npz-mjlab", said)
        self.assertEqual(len(self.rows("again.csv")[0]), 30)


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
        # Bodies follow the joints that move them.
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


if __name__ == "__main__":
    unittest.main()
