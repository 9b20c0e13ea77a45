"""Formats that trainers read, by readers of their own: each takes what the trainer's loader takes,
by the same keys, columns and orders (docs/formats.md names the loaders)."""

import json
import os
import pickle
import re
import resource
import unittest

from formats_test import BREADTH_FIRST
from motion_formats import GOLDEN, FormatsTest
from tool import SHARED, needs_posix, needs_shared, sample
from torch_writer import torch_bytes

try:
    import numpy as np
    import torch_reader
except ImportError:
    np = None

# SONIC's table: the index of each of MuJoCo's joints of the G1 in Isaac Lab's order.
ISAACLAB_TO_MUJOCO = [0, 3, 6, 9, 13, 17, 1, 4, 7, 10, 14, 18, 2, 5, 8, 11, 15, 19, 21, 23, 25, 27,
                      12, 16, 20, 22, 24, 26, 28]
SONIC_BODIES = [0, 4, 10, 18, 5, 11, 19, 9, 16, 22, 28, 17, 23, 29]
# Indices in ProtoMotions' model of the G1.
PROTO_FEET = {"left": 7, "right": 13}


def rotation_matrices(quaternions):
    """(F, 3, 3) of quaternions x y z w."""
    x, y, z, w = quaternions.T
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
                     2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                     2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
                    -1).reshape(-1, 3, 3)


def of_rotation_vectors(vectors):
    """Quaternions x y z w; as MimicKit's exp_map_to_quat."""
    angles = np.linalg.norm(vectors, axis=-1, keepdims=True)
    axes = np.where(angles > 1e-9, vectors / np.maximum(angles, 1e-9), [0, 0, 1])
    return np.concatenate([axes * np.sin(angles / 2), np.cos(angles / 2)], -1)


def same_rotations(a, b):
    """Returns the largest quaternion difference, with q and -q equal."""
    return np.minimum(np.abs(a - b).max(-1), np.abs(a + b).max(-1)).max()


def read_sonic_csv(path):
    """Reads like MotionDataReader::ReadCSV: skips the first line, splits cells at commas."""
    lines = path.read_text().splitlines()[1:]
    return np.array([[float(cell) for cell in line.split(",")] for line in lines])


class Written(FormatsTest):
    """Files made from the golden walk, which has 301 frames at 30 fps."""

    def setUp(self):
        super().setUp()
        self.csv = np.loadtxt(GOLDEN / "walk.csv", delimiter=",")

    def write_as(self, name, output, *arguments):
        self.converted(GOLDEN / "walk.csv", output, "--format", name, *arguments)

    def read_back(self, name, tolerance="1e-5"):
        self.assert_done(self.run_tool("compare", name, GOLDEN / "walk.csv", "--robot",
                                       "unitree_g1", "--tolerance", tolerance))

    def test_motion_lib(self):
        self.write_as("pkl-motion-lib", "lib.pkl", "--dof", "29")
        motions = self.load("lib.pkl")
        self.assertEqual(list(motions), ["lib"])
        motion = motions["lib"]
        self.assertLess(np.abs(motion["dof"] - self.csv[:, 7:]).max(), 1e-6)
        self.assertEqual(motion["pose_aa"].shape, (301, 30, 3))
        self.assertEqual(motion["fps"], 30)
        root = of_rotation_vectors(motion["pose_aa"][:, 0])
        self.assertLess(same_rotations(root, self.csv[:, 3:7]), 1e-6)
        self.assertLess(same_rotations(motion["root_rot"], self.csv[:, 3:7]), 1e-6)
        # Each joint rotates about one axis.
        self.assertLess(np.abs(motion["pose_aa"][:, 1:].sum(-1) - self.csv[:, 7:]).max(), 1e-6)
        self.assertNotIn("contact_mask", motion)
        self.read_back("lib.pkl")
        self.assertIn("pkl-motion-lib", self.converted("lib.pkl", "again.csv"))

    def test_names_of_one_motion(self):
        self.write_as("pkl-motion-lib", "lib.pkl")
        motion = self.load("lib.pkl")["lib"]
        self.write("two.pkl", pickle.dumps({"a": motion, "b": motion}))
        self.assert_fails(self.convert("two.pkl", "b.csv"), 3, "--motion: a, b")
        self.converted("two.pkl", "b.csv", "--motion", "b")

    def test_mimickit(self):
        self.write_as("pkl-mimickit", "walk.pkl")
        motion = self.load("walk.pkl")
        self.assertEqual((motion["loop_mode"], motion["fps"]), (0, 30))
        self.assertIsInstance(motion["frames"], list)
        frames = np.array(motion["frames"], dtype=np.float32)
        self.assertLess(np.abs(frames[:, :3] - self.csv[:, :3]).max(), 1e-6)
        self.assertLess(same_rotations(of_rotation_vectors(frames[:, 3:6]), self.csv[:, 3:7]),
                        1e-6)
        self.assertLess(np.abs(frames[:, 6:] - self.csv[:, 7:]).max(), 1e-6)
        self.read_back("walk.pkl")

    def test_holosoma(self):
        self.write_as("npz-holosoma", "holo.npz")
        self.write_as("npz-mjlab", "mjlab.npz")
        self.write_as("npz-beyondmimic", "isaac.npz")
        motion, mjlab = np.load(self.folder / "holo.npz"), np.load(self.folder / "mjlab.npz")
        names, bodies = motion["joint_names"].tolist(), motion["body_names"].tolist()
        self.assertEqual(motion["joint_pos"].shape, (500, 36))
        self.assertEqual(motion["joint_vel"].shape, (500, 35))
        self.assertEqual(motion["joint_pos"].shape[1] - 7, len(names))
        self.assertEqual(len(bodies), motion["body_pos_w"].shape[1])
        self.assertEqual(names, mjlab["joint_names"].tolist())
        for key, skipped in (("joint_pos", 7), ("joint_vel", 6)):
            self.assertTrue(np.array_equal(motion[key][:, skipped:], mjlab[key]), key)
        # Its loader looks up bodies by name, including fixed ones.
        self.assertIn("left_rubber_hand", bodies)
        self.assertEqual(len(set(bodies)), len(bodies))
        index = [bodies.index(name) for name in mjlab["body_names"]]
        for key in ("body_pos_w", "body_quat_w", "body_ang_vel_w"):
            self.assertTrue(np.array_equal(motion[key][:, index], mjlab[key]), key)
        # Isaac Sim's velocities are those of centres of mass.
        isaac = np.load(self.folder / "isaac.npz")
        index = [bodies.index(name) for name in isaac["body_names"]]
        self.assertTrue(np.array_equal(motion["body_lin_vel_w"][:, index],
                                       isaac["body_lin_vel_w"]))
        pelvis = bodies.index("pelvis")
        self.assertTrue(np.array_equal(motion["joint_pos"][:, :3], motion["body_pos_w"][:, pelvis]))
        self.assertTrue(np.array_equal(motion["joint_pos"][:, 3:7],
                                       motion["body_quat_w"][:, pelvis]))
        # As in qvel: the velocity of the root's origin, not of its centre of mass.
        root = mjlab["body_names"].tolist().index("pelvis")
        self.assertTrue(np.array_equal(motion["joint_vel"][:, :3], mjlab["body_lin_vel_w"][:, root]))
        self.assertTrue(np.array_equal(motion["joint_vel"][:, 3:6], mjlab["body_ang_vel_w"][:, root]))
        self.converted("holo.npz", "a.csv")
        self.converted("mjlab.npz", "b.csv")
        self.assert_done(self.run_tool("compare", "a.csv", "b.csv"))

    def test_sonic(self):
        self.write_as("csv-sonic", "walk")
        self.write_as("npz-beyondmimic", "isaac.npz")
        isaac = np.load(self.folder / "isaac.npz")
        folder = self.folder / "walk"
        tables = {path.stem: read_sonic_csv(path) for path in folder.glob("*.csv")}
        self.assertEqual(sorted(tables), ["body_ang_vel", "body_lin_vel", "body_pos", "body_quat",
                                          "joint_pos", "joint_vel"])
        for name, columns in (("joint_pos", 29), ("joint_vel", 29), ("body_pos", 42),
                              ("body_quat", 56), ("body_lin_vel", 42), ("body_ang_vel", 42)):
            self.assertEqual(tables[name].shape, (501, columns), name)
        # 10 s at 50 fps, including the last frame; dof[k] = joint_pos[:, ISAACLAB_TO_MUJOCO[k]].
        dof = tables["joint_pos"][:, ISAACLAB_TO_MUJOCO]
        self.assertLess(np.abs(dof[::5] - self.csv[::3, 7:]).max(), 1e-8)
        text = (folder / "metadata.txt").read_text()
        lines = text.splitlines()
        numbers = re.findall(r"\d+", lines[lines.index("Body part indexes:") + 1])
        self.assertEqual([int(number) for number in numbers], SONIC_BODIES)
        self.assertIn("Total timesteps: 501", text)
        self.assertEqual([name.removesuffix("_joint") for name in isaac["joint_names"]],
                         BREADTH_FIRST)
        for name, width in (("body_pos", 3), ("body_quat", 4), ("body_ang_vel", 3)):
            found = tables[name].reshape(501, 14, width)[:499]
            expected = isaac[f"{name}_w"][:499, SONIC_BODIES]
            self.assertLess(np.abs(found - expected).max(), 1e-5, name)
        self.assertLess(np.abs(tables["joint_vel"][:499] - isaac["joint_vel"][:499]).max(), 1e-5)
        # Velocities of the body origins.
        steps = np.gradient(tables["body_pos"], 0.02, axis=0)
        self.assertLess(np.abs(steps - tables["body_lin_vel"])[1:-1].max(), 0.15)
        self.assertIn("csv-sonic", self.converted("walk", "a.csv"))
        # Files without the line of names have as many frames.
        for path in folder.glob("*.csv"):
            path.write_text("".join(path.read_text().splitlines(keepends=True)[1:]))
        self.converted("walk", "plain.csv")
        self.assertEqual(self.rows("plain.csv"), self.rows("a.csv"))
        self.converted("isaac.npz", "b.csv")
        a, b = np.array(self.rows("a.csv")), np.array(self.rows("b.csv"))
        self.assertLess(np.abs(a[:500] - b).max(), 2e-6)

    @needs_shared
    def test_protomotions(self):
        self.write_as("protomotions", "walk.motion")
        motion = torch_reader.load(self.folder / "walk.motion")
        self.assertEqual(motion["state_conversion"],
                         ("protomotions.simulator.base_simulator.simulator_state.StateConversion",
                          "common"))
        self.assertEqual(motion["fps"], 30)
        self.assertEqual(motion["dof_pos"].dtype, np.float32)
        self.assertLess(np.abs(motion["dof_pos"] - self.csv[:, 7:]).max(), 1e-6)
        self.assertEqual(motion["rigid_body_pos"].shape, (301, 33, 3))
        self.assertLess(np.abs(motion["rigid_body_pos"][:, 0] - self.csv[:, :3]).max(), 1e-6)
        self.assertLess(same_rotations(motion["rigid_body_rot"][:, 0], self.csv[:, 3:7]), 1e-6)
        steps = np.diff(motion["dof_pos"], axis=0) * 30
        self.assertLess(np.abs(motion["dof_vel"][:-1] - steps).max(), 1e-4)
        self.assertNotIn("rigid_body_contacts", motion)
        # A geom that is fixed to a body moves with it.
        for body, carrier, place in ((1, 0, [0, 0, 0.4]), (24, 23, [0.12, 0, 0]),
                                     (32, 31, [0.12, 0, 0])):
            turn = rotation_matrices(motion["rigid_body_rot"][:, carrier])
            expected = motion["rigid_body_pos"][:, carrier] + turn @ np.array(place)
            self.assertLess(np.abs(motion["rigid_body_pos"][:, body] - expected).max(), 1e-5)
        speeds = np.gradient(motion["rigid_body_pos"], 1 / 30, axis=0)
        self.assertLess(np.abs(speeds - motion["rigid_body_vel"])[1:-1].max(), 0.4)
        self.read_back("walk.motion")
        # The extension identifies the format.
        self.converted(GOLDEN / "walk.csv", "again.motion")
        self.assertEqual((self.folder / "again.motion").read_bytes(),
                         (self.folder / "walk.motion").read_bytes())

    def test_another_state_of_protomotions_is_reported(self):
        self.write_as("protomotions", "a.motion")
        motion = torch_reader.load(self.folder / "a.motion")
        self.write("b.motion", torch_bytes({**motion, "state_conversion": "simulator"}))
        self.assertIn('its state_conversion is "simulator"', self.converted("b.motion", "b.csv"))
        self.assertNotIn("state_conversion", self.converted("a.motion", "a.csv"))

    def test_other_robots(self):
        self.assert_done(self.retarget("--frames", "0:30", "--format",
                                       "protomotions,csv-sonic,npz-holosoma,pkl-motion-lib",
                                       robot="booster_t1_29dof", output="t1"))
        motion = torch_reader.load(self.folder / "t1.motion")
        self.assertEqual(motion["rigid_body_pos"].shape[1], motion["dof_pos"].shape[1] + 1)
        self.assert_done(self.run_tool("compare", "t1.motion", "t1.motion-lib.pkl", "--robot",
                                       "booster_t1_29dof", "--tolerance", "1e-5"))


class Published(FormatsTest):
    """ProtoMotions' own file of a walk is read, written and compared."""

    @needs_shared
    def test_protomotions(self):
        path = SHARED / "data/formats/protomotions_g1_walk.motion"
        self.assertIn("protomotions", self.converted(path, "walk.csv"))
        self.converted(path, "again.motion")
        ours, theirs = torch_reader.load(self.folder / "again.motion"), torch_reader.load(path)
        self.assertEqual(set(ours), set(theirs))
        self.assertEqual(ours["state_conversion"], theirs["state_conversion"])
        self.assertEqual(ours["fps"], theirs["fps"])
        for key, tolerance in (("dof_pos", 1e-6), ("dof_vel", 1e-4), ("rigid_body_pos", 2e-5)):
            self.assertEqual(ours[key].shape, theirs[key].shape)
            self.assertLess(np.abs(ours[key] - theirs[key]).max(), tolerance, key)
        self.assertLess(same_rotations(ours["rigid_body_rot"].reshape(-1, 4),
                                       theirs["rigid_body_rot"].reshape(-1, 4)), 2e-5)
        # Its velocities are smoothed over frames, retarget's are not.
        for key in ("rigid_body_vel", "rigid_body_ang_vel"):
            away = np.abs(ours[key] - theirs[key])
            self.assertLess(away.mean(), 0.1 * np.abs(theirs[key]).max(), key)
        feet = list(PROTO_FEET.values())
        self.assertTrue(np.array_equal(ours["rigid_body_contacts"][:, feet],
                                       theirs["rigid_body_contacts"][:, feet]))


class Solved(FormatsTest):
    """Runs with contacts, and formats with their own rate."""

    FORMATS = ("csv", "npz-mjlab", "pkl-pbhc", "pkl-motion-lib", "protomotions", "csv-sonic")

    def setUp(self):
        super().setUp()
        self.assert_done(self.retarget("--frames", "0:90", "--format", ",".join(self.FORMATS),
                                       "--contacts", "contacts.csv", bvh=sample("walk"),
                                       output="out"))

    def contacts(self, name="contacts.csv"):
        lines = (self.folder / name).read_text().splitlines()
        self.assertEqual(lines[0], "frame,time,left_heel,left_toe,right_heel,right_toe")
        return np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])

    def test_contacts(self):
        table = self.contacts()
        frames = len(self.rows("out.csv"))
        self.assertEqual(table.shape, (frames, 6))
        self.assertTrue(np.allclose(table[:, 1], np.arange(frames) / 30, atol=1e-6))
        flags = table[:, 2:].astype(bool)
        for foot in (flags[:, :2], flags[:, 2:]):  # In a walk, both feet stand and swing.
            self.assertTrue(0.2 < foot.any(-1).mean() < 0.95)
        feet = np.stack([flags[:, :2].any(-1), flags[:, 2:].any(-1)], -1)
        # The loader's check: two dimensions, the second for two feet.
        mask = self.load("out.pbhc.pkl")["out"]["contact_mask"]
        self.assertEqual((mask.shape, mask.dtype), ((frames, 2), np.float32))
        self.assertTrue(np.array_equal(mask.astype(bool), feet))
        self.assertTrue(np.array_equal(self.load("out.motion-lib.pkl")["out"]["contact_mask"],
                                       mask))
        motion = torch_reader.load(self.folder / "out.motion")["rigid_body_contacts"]
        self.assertEqual((motion.shape, motion.dtype), ((frames, 33), np.bool_))
        self.assertTrue(np.array_equal(motion[:, list(PROTO_FEET.values())], feet))
        self.assertEqual(motion.sum(), feet.sum())
        # Planted soles are on the floor and do not move.
        arrays = np.load(self.folder / "out.mjlab.npz")
        self.assertEqual(arrays["contact_names"].tolist(),
                         ["left_heel", "left_toe", "right_heel", "right_toe"])
        self.assertEqual(arrays["contacts"].shape, (len(arrays["joint_pos"]), 4))
        self.assertEqual(arrays["contacts"].dtype, np.bool_)
        ankle = arrays["body_names"].tolist().index("left_ankle_roll_link")
        speed = np.linalg.norm(arrays["body_lin_vel_w"][:, ankle], axis=-1)
        flat = arrays["contacts"][:, 0] & arrays["contacts"][:, 1]
        self.assertLess(speed[flat].mean(), 0.3 * speed[~flat].mean())
        # The same times at another rate, except for a frame or two at each end.
        nearest = flags[np.minimum(np.round(np.arange(len(flat)) * 0.6).astype(int), frames - 1)]
        self.assertGreater((nearest == arrays["contacts"]).mean(), 0.95)
        self.assertTrue(np.array_equal(self.contacts("out.sonic/contacts.csv")[:-1, 2:],
                                       arrays["contacts"]))

    def test_contacts_are_converted(self):
        flags = np.load(self.folder / "out.mjlab.npz")["contacts"]
        self.converted("out.mjlab.npz", "a.npz", "--format", "npz-beyondmimic", "--contacts",
                       "a.csv")
        self.assertTrue(np.array_equal(self.contacts("a.csv")[:, 2:], flags))
        self.assertTrue(np.array_equal(np.load(self.folder / "a.npz")["contacts"], flags))
        # At another rate, each sample takes the values of the nearest frame.
        self.converted("out.mjlab.npz", "b.csv", "--fps", "25", "--contacts", "c.csv")
        self.assertTrue(np.array_equal(self.contacts("c.csv")[:, 2:], flags[::2]))
        for name in ("out.pbhc.pkl", "out.motion", "out.sonic"):
            self.converted(name, "d.csv", "--contacts", "e.csv")
            self.assertGreater(self.contacts("e.csv")[:, 2:].sum(), 10, name)
        self.assert_fails(self.convert(GOLDEN / "walk.csv", "f.csv", "--contacts", "g.csv"), 2,
                          "no contacts")
        self.assertFalse((self.folder / "f.csv").exists())

    def test_tracking_files_are_solved_at_their_rate(self):
        self.assert_done(self.retarget("--frames", "0:90", bvh=sample("walk"), output="alone.csv"))
        self.assertEqual((self.folder / "alone.csv").read_bytes(),
                         (self.folder / "out.csv").read_bytes())
        self.assert_done(self.retarget("--frames", "0:90", "--fps", "50", bvh=sample("walk"),
                                       output="fast.csv"))
        fast = np.array(self.rows("fast.csv"))
        together = np.load(self.folder / "out.mjlab.npz")
        self.assertLess(np.abs(together["joint_pos"] - fast[:-1, 7:]).max(), 1e-6)
        # Also alone, with the same bytes.
        result = self.retarget("--frames", "0:90", "--format", "npz-mjlab", "--sidecar",
                               bvh=sample("walk"), output="alone.npz")
        self.assert_done(result)
        self.assertIn(f"{len(fast)} frames at 50 fps", result.stderr)
        self.assertEqual((self.folder / "alone.npz").read_bytes(),
                         (self.folder / "out.mjlab.npz").read_bytes())
        self.assert_done(self.run_tool("verify", "alone.npz.json"))
        # Interpolation leaves corners.
        self.converted("out.csv", "slow.npz", "--format", "npz-mjlab")
        slow = np.load(self.folder / "slow.npz")

        def jerk(motion):
            return np.percentile(np.abs(np.diff(motion["joint_pos"], 3, axis=0)), 99)

        self.assertLess(jerk(together), 0.8 * jerk(slow))

    def test_files_at_two_rates_start_in_one_world(self):
        def apart(output, *options):
            self.assert_done(self.retarget("--frames", "0:90", "--format", "csv,npz-mjlab", *options,
                                           bvh=sample("walk"), output=output))
            slow = np.array(self.rows(f"{output}.csv"))[::3, :2]
            fast = np.load(self.folder / f"{output}.mjlab.npz")["body_pos_w"][::5, 0, :2]
            return np.linalg.norm(slow[:len(fast)] - fast[:len(slow)], axis=1)

        # Solutions at two rates differ; the transform must not add to this.
        self.assertLess(np.abs(apart("a") - apart("b", "--normalize-start")).max(), 1e-5)

    def test_counts_and_reports_are_those_of_the_files(self):
        for name in ("npz-mjlab", "npz-holosoma", "protomotions", "pkl-motion-lib"):
            with self.subTest(name):
                result = self.retarget("--frames", "0:40", "--fps", "50", "--format", name,
                                       "--report", "run.json", bvh=sample("walk"), output="file")
                self.assert_done(result)
                self.run_tool("evaluate", "file", "--robot", "unitree_g1", "--bvh",
                              sample("walk"), "--frames", "0:40", "--json", "again.json")
                reports = [json.loads((self.folder / file).read_text())["motions"][0]
                           for file in ("run.json", "again.json")]
                if name.startswith("npz"):
                    self.assertIn(f"wrote    file ({reports[0]['frames']} frames at 50 fps)",
                                  result.stderr)
                for key, value in reports[1].items():
                    if isinstance(value, (int, float)) and key != "passed":
                        self.assertAlmostEqual(reports[0][key], value, 9, key)
        frames = np.load(self.folder / "out.mjlab.npz")["joint_pos"].shape[0]
        for output in ("a.npz", "b.npz"):
            self.converted("out.mjlab.npz", output, "--format", "npz-beyondmimic")
            self.assertEqual(np.load(self.folder / output)["joint_pos"].shape[0], frames)

    def test_sidecars_of_folders(self):
        self.assert_done(self.retarget("--frames", "0:30", "--format", "csv-sonic,csv",
                                       "--sidecar", output="s"))
        for name in ("s.sonic.json", "s.csv.json"):
            self.assert_done(self.run_tool("verify", name))
        text = (self.folder / "s.sonic" / "joint_pos.csv").read_text()
        self.write("s.sonic/joint_pos.csv", text.replace("1", "2"))
        self.assert_fails(self.run_tool("verify", "s.sonic.json"), 1, "changed")

    def test_the_published_method_has_no_contacts(self):
        self.assert_fails(self.retarget("--method", "gmr", "--contacts", "x.csv"), 2, "--contacts")
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:9", "--format",
                                       "pkl-pbhc", output="gmr.pkl"))
        self.assertNotIn("contact_mask", self.load("gmr.pkl")["gmr"])


class Batches(FormatsTest):
    def batch(self, *arguments):
        for name in ("walk", "wave"):
            if not (self.folder / f"clips/{name}.bvh").exists():
                self.write(f"clips/{name}.bvh", sample(name).read_bytes())
        return self.run_tool("batch", "clips", "--robot", "unitree_g1", "-o", "out", "--frames",
                             "0:30", *arguments)

    def test_lists(self):
        self.assert_done(self.batch("--format", "pkl-gmr", "--dof", "23-pbhc", "--motion-list",
                                    "--contacts"))
        text = (self.folder / "out/motions.yaml").read_text()
        files = re.findall(r'- file: "(.*)"\n    weight: 1.0\n    description: "(.*)"', text)
        self.assertEqual(files, [("walk.pkl", "walk"), ("wave.pkl", "wave")])
        # Wine's drive Z: is the root of the file system.
        root = re.match(r'root_path: "(?:Z:)?(.*)"\nmotions:\n', text).group(1)
        for file, name in files:
            # The input of TWIST2's loader.
            with open(os.path.join(root, file), "rb") as pickled:
                motion = pickle.load(pickled)
            self.assertEqual(motion["dof_pos"].shape, (30, 23))
            self.assertEqual(motion["root_rot"].shape, (30, 4))
            self.assertEqual(motion["local_body_pos"].shape, (30, len(motion["link_body_list"]), 3))
            self.assertTrue((self.folder / f"out/{name}.contacts.csv").exists())
        try:
            import yaml
        except ImportError:
            return
        self.assertEqual(len(yaml.safe_load(text)["motions"]), 2)

    def test_lists_need_one_format(self):
        self.assert_fails(self.batch("--format", "csv", "--motion-list"), 2, "--motion-list")
        self.assert_fails(self.batch("--format", "pkl-gmr,pkl-pbhc", "--motion-list"), 2,
                          "exactly one of the formats")

    def test_folders(self):
        self.assert_done(self.batch("--format", "csv-sonic"))
        for name in ("walk", "wave"):
            self.assertEqual(len(read_sonic_csv(self.folder / f"out/{name}/joint_pos.csv")), 49)
        result = self.batch("--format", "csv-sonic", "--resume")
        self.assert_done(result)
        self.assertIn("2 of 2 are done and unchanged", result.stderr)
        (self.folder / "out/walk/metadata.txt").unlink()
        self.assertIn("1 of 2 are done", self.batch("--format", "csv-sonic", "--resume").stderr)
        self.assertTrue((self.folder / "out/walk/metadata.txt").exists())


class BadFiles(FormatsTest):
    @needs_posix
    def test_a_failed_write_leaves_no_folder(self):
        small = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000))
        result = self.run_tool("convert", GOLDEN / "walk.csv", "walk", "--robot", "unitree_g1",
                               "--format", "csv-sonic", preexec_fn=small)
        self.assert_fails(result, 1, "cannot write the file")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_folders_appear_complete_or_not_at_all(self):
        self.write("walk/mine.txt", "keep me")
        result = self.convert(GOLDEN / "walk.csv", "walk", "--format", "csv-sonic")
        self.assert_fails(result, 2, "mine.txt")
        self.assertEqual(self.files(), ["walk/mine.txt"])
        (self.folder / "walk/mine.txt").unlink()
        for _ in range(2):  # Once into an empty folder, and once over the existing motion.
            self.converted(GOLDEN / "walk.csv", "walk", "--format", "csv-sonic")
            self.assertEqual(len(self.files()), 7)
        self.assertEqual([path.name for path in self.folder.iterdir() if path.name != "data home"],
                         ["walk"])
        self.assert_fails(self.convert(GOLDEN / "walk.csv", "-", "--format", "csv-sonic"), 2,
                          "standard output")
        self.assert_fails(self.convert(GOLDEN / "walk.csv", "x.csv", "--format", "csv-sonic"), 2,
                          "makes a folder")

    def test_invalid_motions(self):
        self.write("weights.pt", torch_bytes({"layer.weight": np.zeros((3, 3), np.float32)}))
        self.assert_fails(self.convert("weights.pt", "x.csv"), 3, "dof_pos", "layer.weight")
        row = [0.0, 0.0, 0.8, 0.0, 0.0, 0.0] + [0.0] * 29
        for frames, words in (([], "no frames"), ([row, row[:-1]], "different lengths"),
                              ([row[:5]], "no joints"), ([["a"] * 35], "non-numeric"), (7, "list"),
                              ([row[:3] + [1e9] + row[4:]], "longer than any rotation"),
                              ([[float("nan")] + row[1:]], "not finite")):
            with self.subTest(words=words):
                self.write("bad.pkl", pickle.dumps({"loop_mode": 0, "fps": 30, "frames": frames}))
                self.assert_fails(self.convert("bad.pkl", "x.csv"), 3, words)
        # One row that represents many.
        bomb = b"\x80\x04}(\x8c\x09loop_modeK\x00\x8c\x03fpsK\x1e\x8c\x06frames]("
        bomb += b"](" + b"K\x00" * 20_000 + b"eq\x00" + b"h\x00" * 20_000 + b"eu."
        self.write("bad.pkl", bomb)
        self.assert_fails(self.convert("bad.pkl", "x.csv"), 3, "than the file size allows")
        self.converted(GOLDEN / "walk.csv", "walk", "--format", "csv-sonic")
        text = (self.folder / "walk/joint_pos.csv").read_text()
        for changed, words in ((text.replace(",", ";", 40), "not a number"),
                               (text.rsplit(",", 1)[0] + "\n", "expected 29 numbers"),
                               ("joint_0\n", "no frames"), ("a\n0\n", "different numbers of frames or bodies"),
                               (text.replace("0.", "9."), "are these degrees?")):
            with self.subTest(words=words):
                self.write("walk/joint_pos.csv", changed)
                self.assert_fails(self.convert("walk", "x.csv"), 3, words)
        self.write("walk/joint_pos.csv", text)
        quaternions = self.folder / "walk/body_quat.csv"
        rows = np.loadtxt(quaternions, delimiter=",", skiprows=1)
        moved = rows.reshape(len(rows), -1, 4)[..., [1, 2, 3, 0]].reshape(rows.shape)
        np.savetxt(quaternions, moved, delimiter=",", header="x", comments="")
        self.assert_fails(self.convert("walk", "x.csv"), 3, "forward kinematics",
                          "they fit if the root quaternion is x y z w")
        self.assertFalse((self.folder / "x.csv").exists())


if __name__ == "__main__":
    unittest.main()
