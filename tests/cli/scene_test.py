"""Fits in a scene, and the judge of scenes, which must notice a robot that is moved."""

import array
import json
import unittest
import zipfile

from scene_outputs_test import SCENE
from tool import SHARED, ToolTest, moved_clip, raised_clip, read_rows, sample, unwrapped

DATA = SHARED / "data"
SCENES, FORMATS = DATA / "scenes", DATA / "formats"


def tensor_rows(path, columns):
    """The rows of the only tensor of a PyTorch file, float32."""
    with zipfile.ZipFile(path) as file:
        name = next(name for name in file.namelist() if name.endswith("data/0"))
        values = array.array("f", file.read(name))
    return [values[i:i + columns] for i in range(0, len(values), columns)]


def share_near(frames, others, reach=2):
    """The share of frames that have one of the others within `reach` frames."""
    return sum(any(frame + i in others for i in range(-reach, reach + 1)) for frame in frames) / len(frames)


class SceneTest(ToolTest):
    def report(self, *arguments):
        """The report of a run that passes all gates, and its motion."""
        result = self.run_tool(*arguments, "--robot", "unitree_g1", "-o", "out.csv", "--report",
                               "out.json")
        self.assert_done(result)
        return json.loads((self.folder / "out.json").read_text())["motions"][0]

    def missed_when_moved(self, x, z, *source):
        """The missed gates of the motion moved by x and z metres."""
        rows = read_rows((self.folder / "out.csv").read_text())
        for row in rows:
            row[0] += x
            row[2] += z
        self.write("moved.csv", "\n".join(",".join(f"{v:.6f}" for v in row) for row in rows) + "\n")
        result = self.run_tool("evaluate", "moved.csv", "--robot", "unitree_g1", *source, "--json",
                               "moved.json")
        self.assertEqual(result.returncode, 1, result.stdout)
        motion = json.loads((self.folder / "moved.json").read_text())["motions"][0]
        return {gate["metric"] for gate in motion["gates"] if not gate["passed"]}

    def need_shared(self):
        if not SCENES.is_dir():
            self.skipTest("no folder of shared data: set RETARGET_SHARED to run this test")

    def assert_in_scene(self, motion, limb_angle):
        missed = [gate["metric"] for gate in motion["gates"] if gate["passed"] is False]
        self.assertEqual(missed, [])
        self.assertEqual(motion["scene_pen_1cm_pct"], 0.0)
        self.assertGreaterEqual(motion["scene_contact_kept_pct"], 97.0)
        self.assertLessEqual(motion["root_jerk_mean"], 30.0)
        angle = motion["limb_angle_deg"]
        self.assertLess(angle[0] if isinstance(angle, list) else angle, limb_angle)

    def test_stands_on_a_step(self):
        self.write("raised.bvh", raised_clip())
        self.write("room.json", json.dumps(SCENE))
        source = ("--bvh", "raised.bvh", "--scene", "room.json")
        motion = self.report(*source)
        self.assertGreater(motion["scene_contact_pct"], 50.0)
        self.assertEqual(motion["scene_contact_kept_pct"], 100.0)
        self.assertEqual(motion["scene_pen_1cm_pct"], 0.0)
        self.assertIn("scene_pen_1cm_pct", self.missed_when_moved(0.0, -0.05, *source))
        self.assertIn("scene_contact_kept_pct", self.missed_when_moved(0.0, 0.05, *source))

    def box(self, height, **members):
        """A scene of one large box on the floor."""
        self.write("box.json", json.dumps({"bodies": [{
            "name": "box", "position": [0.0, 0.0, height / 2],
            "shapes": [{"type": "box", "size": [30.0, 30.0, height]}], **members}]}))
        return "--scene", "box.json"

    def test_lies_on_a_bed_and_on_a_mat(self):
        for height in (0.5, 0.1):
            self.write("raised.bvh", raised_clip("get_up", 286, 100.0 * height))
            result = self.run_tool("--bvh", "raised.bvh", "--up", "y", *self.box(height), "--robot", "unitree_g1",
                                   "-o", "out.csv", "--report", "out.json")
            self.assertIn(result.returncode, (0, 1), result.stderr)
            motion = json.loads((self.folder / "out.json").read_text())["motions"][0]
            self.assertEqual(motion["scene_pen_1cm_pct"], 0.0, height)

    def test_stands_on_a_body_at_rest_that_may_move(self):
        self.write("raised.bvh", raised_clip("squat", 60, 30.0))
        rows = []
        for members in ({}, {"moves": True}):
            motion = self.report("--bvh", "raised.bvh", *self.box(0.3, **members))
            self.assertEqual(motion["scene_pen_1cm_pct"], 0.0)
            rows.append(read_rows((self.folder / "out.csv").read_text()))
        self.assertEqual(rows[0], rows[1])

    def test_feet_on_a_moving_platform_give_a_warning_and_keep_the_root(self):
        self.write("ride.bvh", moved_clip("squat", 120, lambda i, p: [p[0] + 1.7 * i, p[1] + 30.0, p[2]]))
        # The BVH has y up, and its x is the x of the world.
        self.write("box.csv", "x,y,z,qw,qx,qy,qz\n" + "".join(
            f"{0.017 * i:.4f},0,0.15,1,0,0,0\n" for i in range(120)))
        result = self.run_tool("--bvh", "ride.bvh", "--robot", "unitree_g1", *self.box(0.3),
                               "--object-track", "box=box.csv", "-o", "out.csv")
        self.assertIn(result.returncode, (0, 1), result.stderr)
        self.assertIn('feet stand on "box" while its track moves it', unwrapped(result.stderr))
        self.assertNotIn("the root moved", result.stdout)
        rows = read_rows((self.folder / "out.csv").read_text())
        self.assertGreater(rows[-1][0] - rows[0][0], 1.0)

    def test_clip_axes_accept_a_large_scene_in_centimetres(self):
        self.write("raised.bvh", raised_clip())
        # The unit of the clip is the centimetre.
        self.write("far.json", json.dumps({"bodies": [
            {"name": "step", "position": [0, 10, 0], "shapes": [{"type": "box", "size": [200, 20, 200]}]},
            {"name": "hill", "position": [0, 0, 5000], "shapes": [{"type": "box", "size": [2000, 10, 2000]}]}]}))
        motion = self.report("--bvh", "raised.bvh", "--scene", "far.json", "--scene-axes", "clip")
        self.assertEqual(motion["scene_contact_kept_pct"], 100.0)

    def test_distant_bodies_change_nothing(self):
        """The joints are smoother only near contacts. In a scene, the fit omits the dynamics."""
        self.write("far.json", json.dumps({"bodies": [
            {"name": "box", "position": [50.0, 50.0, 0.5], "shapes": [{"type": "box", "size": [0.5] * 3}]}]}))
        self.report(sample("walk"), "--scene", "far.json")
        in_scene = read_rows((self.folder / "out.csv").read_text())
        self.report(sample("walk"), "--without", "dynamics")
        alone = read_rows((self.folder / "out.csv").read_text())
        self.assertEqual(len(in_scene), len(alone))
        difference = max(abs(a - b) for one, other in zip(in_scene, alone) for a, b in zip(one, other))
        self.assertLess(difference, 1e-5)

    def test_a_scene_moves_with_the_start(self):
        self.write("raised.bvh", raised_clip())
        self.write("room.json", json.dumps(SCENE))
        source = ("--bvh", "raised.bvh", "--scene", "room.json")
        motion = self.report(*source, "--normalize-start", "--sidecar")
        self.assertEqual(motion["scene_contact_kept_pct"], 100.0)
        self.assertEqual(motion["scene_pen_1cm_pct"], 0.0)
        result = self.run_tool("evaluate", "out.csv", "--robot", "unitree_g1", *source)
        self.assertIn("--normalize-start", result.stderr)

    def test_climbs(self):
        self.need_shared()
        source = (SCENES / "climb_seq_1__mocap_climb_seq_1_joint_positions_f0-2422.npy", "--scene",
                  SCENES / "climb_seq_1__multi_boxes.obj")
        self.assert_in_scene(self.report(*source), 5.5)
        judged = ("--bvh", *source)
        for x, z in ((0.0, -0.05), (0.0, 0.05)):
            missed = self.missed_when_moved(x, z, *judged)
            self.assertTrue({name for name in missed if name.startswith("scene_")}, (x, z, missed))

    def test_carries_a_box(self):
        self.need_shared()
        carry = FORMATS / "omomo_sub3_largebox_003.pt"
        motion = self.report(carry, "--scene", SCENES / "largebox__largebox.obj", "--object-track",
                             carry)
        self.assert_in_scene(motion, 6.5)
        self.assertLess(motion["scene_gap_p95_cm"], 1.0)

    def test_objects_follow_the_hands(self):
        self.need_shared()
        carry = FORMATS / "omomo_sub3_largebox_003.pt"
        box = ("--scene", SCENES / "largebox__largebox.obj", "--object-track", carry,
               "--object-shift", "0.2,0,0")
        given = self.report(carry, *box)
        followed = self.report(carry, *box, "--object-motion", "fitted", "--sidecar")
        for motion in (given, followed):
            self.assert_in_scene(motion, 6.5)
        self.assertLess(followed["limb_angle_deg"][0], given["limb_angle_deg"][0])
        self.assertRegex(" ".join(followed["fit"]["notes"]), r"the robot displaces \w*box by up to")
        result = self.run_tool("evaluate", "out.csv", "--robot", "unitree_g1", "--bvh", carry, *box)
        self.assertIn("--object-motion fitted", result.stderr)

    def test_dynamics_count_the_scene(self):
        self.need_shared()
        source = (SCENES / "climb_seq_1__mocap_climb_seq_1_joint_positions_f0-2422.npy", "--scene",
                  SCENES / "climb_seq_1__multi_boxes.obj")
        self.report(*source)
        bad = []
        for scene in (source[1:], ()):
            self.run_tool("evaluate", "out.csv", "--robot", "unitree_g1", "--bvh", source[0], *scene,
                          "--dynamics", "--json", "bad.json")
            report = json.loads((self.folder / "bad.json").read_text())["motions"][0]
            bad.append(report["dynamics_bad_pct"])
        self.assertLess(bad[0], 10.0)
        self.assertGreater(bad[1], 60.0)

    def found_contacts(self, carry, track):
        self.assert_done(self.run_tool(
            "contacts", carry, "--robot", "unitree_g1", "--scene", SCENES / "largebox__largebox.obj",
            "--object-track", track, "--json", "contacts.json"))
        return json.loads((self.folder / "contacts.json").read_text())["contacts"]

    def test_contacts_agree_with_the_labels_of_a_carried_box(self):
        self.need_shared()
        carry = FORMATS / "omomo_sub3_largebox_003.pt"
        rows = tensor_rows(carry, 591)
        # A track without the labels, so that distances and speeds decide.
        self.write("box.csv", "x,y,z,qx,qy,qz,qw\n" + "".join(
            ",".join(f"{value:.9g}" for value in row[318:325]) + "\n" for row in rows))
        found = self.found_contacts(carry, "box.csv")
        # Columns 331 to 382 label 52 bodies of SMPL-X; hands and fingers are these.
        for part, bodies in (("left_hand", range(17, 33)), ("right_hand", range(36, 52))):
            labels = {frame for frame, row in enumerate(rows)
                      if any(row[331 + body] > 0.5 for body in bodies)}
            touches = {frame for contact in found
                       if contact["part"] == part and contact["surface"] != "floor"
                       for frame in range(contact["first"], contact["last"] + 1)}
            precision, recall = share_near(touches, labels), share_near(labels, touches)
            score = 2 * precision * recall / (precision + recall)
            self.assertGreaterEqual(score, 0.95, (part, precision, recall))
            # The file's own labels are used unchanged.
            stated = {frame for contact in self.found_contacts(carry, carry)
                      if contact["part"] == part and contact["surface"] != "floor"
                      for frame in range(contact["first"], contact["last"] + 1)}
            self.assertEqual(stated, labels)

    def test_a_given_rate_applies_to_the_objects_of_the_file(self):
        self.need_shared()
        carry = FORMATS / "omomo_sub3_largebox_003.pt"
        lasts = []
        for rate in ((), ("--source-fps", "60")):
            self.assert_done(self.run_tool(
                "contacts", carry, "--robot", "unitree_g1", "--scene",
                SCENES / "largebox__largebox.obj", "--object-track", carry, *rate, "--json",
                "contacts.json"))
            found = json.loads((self.folder / "contacts.json").read_text())
            lasts.append(max(contact["last"] / found["fps"] for contact in found["contacts"]
                             if contact["surface"] != "floor"))
        self.assertAlmostEqual(lasts[1], lasts[0] / 2, delta=0.05)

    def test_contradictions(self):
        self.write("room.json", json.dumps(SCENE))
        self.assert_fails(self.retarget("--scene", "room.json", "--method", "gmr",
                                        bvh=sample("walk")), 2, "--method")
        self.assert_fails(self.retarget("--object-track", "crate.csv", bvh=sample("walk")), 2,
                          "--scene")
        self.assert_fails(self.retarget("--scene", "room.json", "--travel", "0.9",
                                        bvh=sample("walk")), 2, "--travel")
        self.assert_fails(self.retarget("--scene", "absent.json", bvh=sample("walk")), 3,
                          "absent.json")
        self.write("broken.json", '{"bodies": [{"shapes": [{"type": "box", "size": [1, 1]}]}]}')
        self.assert_fails(self.retarget("--scene", "broken.json", bvh=sample("walk")), 3, "size")


if __name__ == "__main__":
    unittest.main()
