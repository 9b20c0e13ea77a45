"""Files of joint positions without rotations: their layouts, units and axes, and what is wrong with them."""

import io
import json
import os
import pickle
import unittest

from joint_positions import PositionsTest, numpy
from tool import sample

SMPL = ("pelvis left_hip right_hip spine1 left_knee right_knee spine2 left_ankle right_ankle spine3 "
        "left_foot right_foot neck left_collar right_collar head left_shoulder right_shoulder "
        "left_elbow right_elbow left_wrist right_wrist").split()
LAFAN1 = ("Hips LeftUpLeg RightUpLeg Spine LeftLeg RightLeg Spine1 LeftFoot RightFoot Spine2 LeftToe "
          "RightToe Neck LeftShoulder RightShoulder Head LeftArm RightArm LeftForeArm RightForeArm "
          "LeftHand RightHand").split()


@unittest.skipIf(numpy is None, "needs numpy")
class PositionsFiles(PositionsTest):
    def smpl_places(self, name="walk", unit=0.01):
        """Places of SMPL's joints (F, 22, 3), metres, Y up, from a sample with LAFAN1's."""
        names, places = self.places_of(sample(name))
        return unit * places[:, [names.index(joint) for joint in LAFAN1]]

    def rows_of(self, motion, *options):
        result = self.run_tool(motion, "g1", "-o", "out.csv", *options)
        self.assert_done(result)
        return (self.folder / "out.csv").read_bytes(), result.stderr

    def test_one_motion_in_many_files(self):
        places = self.smpl_places()
        numpy.save(self.folder / "new_joints.npy", places)
        expected, said = self.rows_of("new_joints.npy")
        for words in ("20 fps, as HumanML3D and MDM have", "the joint order of SMPL", "up +y",
                      "unit m", "left_wrist, right_wrist, head"):
            self.assertIn(words, said)
        many = numpy.stack([places[::-1], places]).transpose(0, 2, 3, 1)
        padded = numpy.concatenate([many, numpy.zeros((2, 22, 3, 5))], axis=3)
        frames = len(places)
        files = {
            "single.npy": (lambda f: numpy.save(f, many[1]), ()),
            "fortran.npy": (lambda f: numpy.save(f, numpy.asfortranarray(places)), ()),
            "big_endian.npy": (lambda f: numpy.save(f, places.astype(">f8")), ()),
            "mdm.npy": (lambda f: numpy.save(f, many), ("--take", 2)),
            "results.npy": (lambda f: numpy.save(f, {
                "motion": padded, "text": ["walks", "turns"], "lengths": numpy.array([9, frames]),
                "num_samples": 2, "num_repetitions": 1}, allow_pickle=True), ("--take", 2)),
            "named.npz": (lambda f: numpy.savez_compressed(
                f, joints=places[:, ::-1], joint_names=SMPL[::-1], fps=20.0), ()),
            "dictionary.pkl": (lambda f: f.write(pickle.dumps(
                {"positions": places, "names": SMPL, "fps": 20})), ()),
            "listed.npy": (lambda f: numpy.save(f, places[:, ::-1].reshape(frames, -1)),
                           ("--joint-names", "names.txt", "--source-fps", 20)),
            "json.npy": (lambda f: numpy.save(f, places[:, ::-1]),
                         ("--joint-names", "names.json")),
        }
        # As written by Windows editors.
        self.write("names.txt", "\ufeff" + "\r\n".join(SMPL[::-1]) + "\r\n")
        self.write("names.json", json.dumps(SMPL[::-1]))
        for name, (write, options) in files.items():
            with self.subTest(name):
                with open(self.folder / name, "wb") as file:
                    write(file)
                self.assertEqual(self.rows_of(name, *options)[0], expected)

    def test_unknown_hand_rotations_let_no_wrist_drift(self):
        numpy.savez(self.folder / "walk.npz", joints=self.smpl_places(), joint_names=SMPL, fps=30)
        for method in ("fit", "gmr"):
            rows = numpy.loadtxt(io.BytesIO(self.rows_of("walk.npz", "--method", method)[0]),
                                 delimiter=",")
            for wrist in (19, 26):  # Roll, pitch and yaw.
                joints = rows[:, 7 + wrist:7 + wrist + 3]
                self.assertLess((joints.max(axis=0) - joints.min(axis=0)).max(), 0.25, method)

    def test_evaluate_ignores_unknown_rotations_as_the_run_does(self):
        numpy.savez(self.folder / "walk.npz", joints=self.smpl_places(), joint_names=SMPL, fps=30)
        self.assert_done(self.run_tool("walk.npz", "g1", "-o", "out.csv", "--report", "run.json"))
        self.assert_done(self.run_tool("evaluate", "out.csv", "--robot", "g1", "--bvh", "walk.npz",
                                       "--json", "e.json", "--gate", "none"))
        run, found = (json.loads((self.folder / name).read_text())["motions"][0]
                      for name in ("run.json", "e.json"))
        self.assertEqual(found["track_rot_deg"], run["track_rot_deg"])
        hands = [row for row in found["tracking"] if "wrist" in row["body"]]
        self.assertTrue(hands)
        self.assertFalse([row for row in hands if row.get("rotation_deg") is not None])

    def test_units_axes_and_sides(self):
        places = self.smpl_places()
        numpy.savez(self.folder / "metres.npz", joints=places, fps=20)
        expected, _ = self.rows_of("metres.npz")
        first = numpy.loadtxt(io.BytesIO(expected), delimiter=",")
        for name, changed, said in (("cm", 100 * places, "unit cm"), ("mm", 1000 * places, "unit mm"),
                                    ("z", places[..., [2, 0, 1]], "up +z")):
            with self.subTest(name):
                numpy.savez(self.folder / "changed.npz", joints=changed, fps=20)
                rows, text = self.rows_of("changed.npz")
                self.assertIn(said, text)
                rows = numpy.loadtxt(io.BytesIO(rows), delimiter=",")
                self.assertLess(abs(rows[:, 7:] - first[:, 7:]).max(), 0.02)

    def test_rates_of_other_orders_are_not_assumed(self):
        _, places = self.places_of(sample("walk"))
        numpy.save(self.folder / "lafan.npy", places)
        self.assert_fails(self.run_tool("lafan.npy", "g1", "-o", "x.csv"), 3, "no frame rate",
                          "LAFAN1", "--source-fps")
        _, said = self.rows_of("lafan.npy", "--source-fps", 30)
        self.assertIn("the joint order of LAFAN1", said)
        numpy.savez(self.folder / "timed.npz", joints=self.smpl_places(), joint_names=SMPL, dt=1 / 30)
        _, said = self.rows_of("timed.npz")
        self.assertNotIn("20 fps", said)

    def test_every_command_takes_them(self):
        numpy.savez(self.folder / "clip.npz", joints=self.smpl_places()[:40], fps=20)
        shown = self.run_tool("inspect", "clip.npz")
        self.assert_done(shown)
        self.assertIn("left_wrist", shown.stdout)
        self.assertIn("is unknown and follows neighbouring joints", shown.stderr)
        self.assert_done(self.run_tool("inspect", "clip.npz", "--html", "page.html"))
        self.assert_done(self.run_tool("edit", "mirror", "clip.npz", "-o", "mirrored.bvh"))
        self.assert_done(self.run_tool("inspect", "mirrored.bvh"))
        self.assert_done(self.run_tool("convert", "clip.npz", "human.glb"))
        (self.folder / "clips").mkdir()
        os.rename(self.folder / "clip.npz", self.folder / "clips/clip.npz")
        numpy.save(self.folder / "clips/weights.npy", numpy.zeros((4, 7)))
        numpy.savez(self.folder / "clips/other.npz", weights=numpy.zeros(3))
        done = self.run_tool("batch", "clips", "-o", "out", "--robot", "g1")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertTrue((self.folder / "out/clip.csv").exists())
        self.assertFalse((self.folder / "out/weights.csv").exists())

    def test_invalid_motions(self):
        self.write("few.txt", "a\nb\n")
        for array, options, words in (
                (numpy.zeros((5, 22, 3)), (), ("in the joint order of SMPL", "--joint-names")),
                (numpy.zeros((5, 9, 3)), ("--source-fps", 30), ("9 joints", "--joint-names")),
                (numpy.zeros((2, 5, 9, 3)), (), ("2 motions", "--take")),
                (numpy.full((5, 22, 3), numpy.nan), (), ("NaN in frame 0, joint 0",)),
                (numpy.zeros((5, 9, 3)), (), ("no known joint order has 9 joints",)),
                (numpy.zeros((5, 22, 3)), ("--joint-names", "few.txt"),
                 ("22 joints", "2 names")),
                (numpy.zeros((5, 2, 3)), ("--joint-names", "few.txt", "--source-fps", 30),
                 ("no human found in the joints a, b",)),
                (numpy.zeros((5, 263)), (), ("HumanML3D features", "new_joints"))):
            numpy.save(self.folder / "odd.npy", array)
            self.assert_fails(self.run_tool("odd.npy", "g1", "-o", "out.csv", *options), 3, *words)
        self.assertNotIn("out.csv", self.files())
        self.write("empty.txt", "\n\n")
        self.assert_fails(self.run_tool("odd.npy", "g1", "-o", "out.csv", "--joint-names",
                                        "empty.txt"), 4, "contains no joint names")
        for text, words in (('{"a": 1}', "found an object"), ("a,b,c\n", "one line with commas")):
            self.write("wrong.txt", text)
            self.assert_fails(self.run_tool("odd.npy", "g1", "-o", "out.csv", "--joint-names",
                                            "wrong.txt"), 4, words, "one name per line")
        self.write("bad.json", '["a", 3]')
        self.assert_fails(self.run_tool("odd.npy", "g1", "-o", "out.csv", "--joint-names",
                                        "bad.json"), 4, "found another value")
        self.assert_fails(self.run_tool(sample("walk"), "g1", "-o", "out.csv", "--joint-names",
                                        "few.txt"), 2, "--joint-names applies only to joint positions")

    def test_a_missing_rate_is_reported_with_faults_that_it_does_not_repair(self):
        noise = numpy.random.default_rng(1).normal(size=(60, 22, 3))
        for places, is_human in ((noise, False), (self.smpl_places(), True)):
            numpy.savez(self.folder / "odd.npz", joints=places, joint_names=SMPL)
            result = self.run_tool("odd.npz", "g1", "-o", "out.csv")
            self.assert_fails(result, 3, "no frame rate", "--source-fps")
            self.assertEqual("the skeleton is not human" in " ".join(result.stderr.split()), not is_human)

    def test_kimodo_has_rotations(self):
        names, places = self.places_of(sample("walk"))
        places = 0.01 * places[:, [names.index(joint) for joint in LAFAN1]]
        turns = numpy.tile(numpy.eye(3), (len(places), 22, 1, 1))
        # A body that glides in a T-pose, according to its rotations.
        still = self.t_pose() + places[:, :1]
        numpy.savez(self.folder / "kimodo.npz", posed_joints=still, global_rot_mats=turns,
                    local_rot_mats=turns, foot_contacts=numpy.zeros((len(places), 4)),
                    root_positions=still[:, 0], smooth_root_pos=still[:, 0])
        _, said = self.rows_of("kimodo.npz")
        self.assertIn("30 fps, as Kimodo's motions have", said)
        self.assertIn("T-pose from zero pose", said)
        self.assertNotIn("rotations were computed", said)

    @staticmethod
    def t_pose():
        """SMPL's joints (22, 3) of a body in a T-pose at the origin, metres, Y up, facing z."""
        return numpy.array([
            [0, 0, 0], [.09, -.08, 0], [-.09, -.08, 0], [0, .11, 0], [.09, -.46, 0], [-.09, -.46, 0],
            [0, .25, 0], [.09, -.87, 0], [-.09, -.87, 0], [0, .31, 0], [.09, -.92, .12],
            [-.09, -.92, .12], [0, .52, 0], [.07, .43, 0], [-.07, .43, 0], [0, .62, 0],
            [.18, .45, 0], [-.18, .45, 0], [.44, .45, 0], [-.44, .45, 0], [.70, .45, 0],
            [-.70, .45, 0]])


if __name__ == "__main__":
    unittest.main()
