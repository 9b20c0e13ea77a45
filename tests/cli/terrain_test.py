"""Terrain under walks, changed scenes, doubts about scenes, and scenes from motion."""

import json
import unittest

import noise
from scene_outputs_test import SCENE
from scene_test import share_near
from tool import ToolTest, raised_clip, read_rows, sample, short_clip

ROBOT = ("--robot", "unitree_g1")
ROOM = {"bodies": SCENE["bodies"][:1]}  # The step alone.
BEFORE, RISING, AFTER = 40, 20, 60  # Frames.


def stepping_clip():
    """The squat, first on the floor, then 60 cm farther and 20 cm higher; positions are in cm."""
    lines = short_clip("squat", BEFORE + RISING + AFTER).decode().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("Frame Time:")) + 1
    for i in range(first, len(lines)):
        share = min(max((i - first - BEFORE) / RISING, 0.0), 1.0)
        share = share * share * (3.0 - 2.0 * share)
        values = lines[i].split()
        values[1] = str(float(values[1]) + 20.0 * share)
        values[2] = str(float(values[2]) + 60.0 * share)
        lines[i] = " ".join(values)
    return "\n".join(lines) + "\n"


class TerrainTest(ToolTest):
    def solve(self, *arguments):
        """The report of a run, and the rows of its CSV."""
        result = self.run_tool(*arguments, *ROBOT, "-o", "out.csv", "--report", "out.json")
        self.assert_done(result)
        report = json.loads((self.folder / "out.json").read_text())["motions"][0]
        return report, read_rows((self.folder / "out.csv").read_text()), result

    def assert_keeps_gates(self, report):
        self.assertEqual([g["metric"] for g in report["gates"] if g["passed"] is False], [])

    def test_walks_up_stairs(self):
        _, flat, _ = self.solve("--bvh", sample("walk"))
        report, rows, _ = self.solve("--bvh", sample("walk"), "--terrain", "stairs:0.1x0.3",
                                     "--scene-out", "up.json")
        self.assert_keeps_gates(report)
        self.assertGreater(report["scene_contact_pct"], 50.0)
        body, = json.loads((self.folder / "up.json").read_text())["bodies"]
        steps = len(body["shapes"])
        # The stairs are as large as asked for in the world of the robot.
        for shape in body["shapes"]:
            self.assertAlmostEqual(shape["size"][2], 0.1, places=4)
        starts = [shape["position"][0] - shape["size"][0] / 2 for shape in body["shapes"]]
        for a, b in zip(starts, starts[1:]):
            self.assertAlmostEqual(b - a, 0.3, places=4)
        climbed = (rows[-1][2] - rows[0][2]) - (flat[-1][2] - flat[0][2])
        self.assertAlmostEqual(climbed, 0.1 * steps, delta=0.12)
        # The judge knows the stairs of the option, and misses a motion that does not climb.
        done = self.run_tool("evaluate", "out.csv", *ROBOT, "--bvh", sample("walk"), "--terrain",
                             "stairs:0.1x0.3")
        self.assert_done(done)
        self.solve("--bvh", sample("walk"))
        missed = self.run_tool("evaluate", "out.csv", *ROBOT, "--bvh", sample("walk"), "--terrain",
                               "stairs:0.1x0.3")
        self.assertEqual(missed.returncode, 1, missed.stdout)

    def test_evaluate_names_a_moved_start(self):
        run = ("--bvh", sample("walk"), *ROBOT, "--terrain", "slope:6", "--end", "4")
        self.assert_done(self.run_tool(*run, "--normalize-start", "--sidecar", "-o", "out.csv"))
        result = self.run_tool("evaluate", "out.csv", *run, "--gate", "none")
        self.assertIn("the sidecar records --normalize-start", result.stderr)

    def contact_frames(self, *arguments):
        """By part: the frames of its contacts, and the surfaces."""
        result = self.run_tool("contacts", sample("walk"), *ROBOT, *arguments, "--json", "-")
        self.assert_done(result)
        frames, surfaces = {}, {}
        for contact in json.loads(result.stdout)["contacts"]:
            part = contact["part"]
            frames.setdefault(part, set()).update(range(contact["first"], contact["last"] + 1))
            surfaces.setdefault(part, set()).add(contact["surface"])
        return frames, surfaces

    def test_labels_on_stairs_are_those_of_the_walk(self):
        truth, floor = self.contact_frames()
        found, surfaces = self.contact_frames("--terrain", "stairs:0.1x0.3")
        self.assertEqual(truth.keys(), found.keys())
        for part in truth:
            self.assertEqual(floor[part], {"floor"})
            self.assertIn("stairs", surfaces[part])
            precision = share_near(found[part], truth[part])
            recall = share_near(truth[part], found[part])
            self.assertGreaterEqual(2 * precision * recall / (precision + recall), 0.95, part)

    def test_walks_up_a_slope(self):
        report, _, _ = self.solve("--bvh", sample("walk"), "--terrain", "slope:6")
        self.assert_keeps_gates(report)
        self.assertGreater(report["scene_contact_pct"], 30.0)

    def test_refuses_terrain_without_a_walk(self):
        result = self.run_tool("--bvh", sample("squat"), *ROBOT, "--terrain", "stairs:0.1x0.3",
                               "-o", "out.csv")
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn("does not walk", result.stderr)
        self.assertFalse((self.folder / "out.csv").exists())
        for wrong in ("stairs:0.1", "stairs:0x0.3", "stairs:0.1x0.3x2.5", "slope:", "slope:80",
                      "hill", "stairs:0.1x0.3x1x1", "stairs:nanx0.3", "slope:-6",
                      "stairs:0.1x0.05"):
            with self.subTest(terrain=wrong):
                result = self.run_tool("--bvh", sample("walk"), *ROBOT, "--terrain", wrong, "-o",
                                       "out.csv")
                self.assertEqual(result.returncode, 2, result.stderr)
                for limits in ("0.005 to 0.5 m", "0.1 to 2 m", "200 steps", "0.5 to 30 degrees"):
                    self.assertIn(limits, result.stderr)

    def test_a_scaled_step_lifts_the_human(self):
        self.write("raised.bvh", raised_clip())
        self.write("room.json", json.dumps(ROOM))
        source = ("--bvh", "raised.bvh", "--scene", "room.json")
        _, before, _ = self.solve(*source)
        report, after, _ = self.solve(*source, "--terrain-scale", "z=1.5")
        self.assert_keeps_gates(report)
        self.assertGreater(after[0][2], before[0][2] + 0.03)
        for one, other in (("--terrain-scale", "z=1"), ("--object-scale", "1")):
            _, same, _ = self.solve(*source, one, other)
            self.assertEqual(same, before)

    def test_scene_changes_require_a_matching_scene(self):
        self.write("raised.bvh", raised_clip())
        self.write("room.json", json.dumps(ROOM))
        for arguments in (("--object-shift", "0,0,0.1"), ("--terrain-scale", "1.1"),
                          ("--scene-axes", "clip"),
                          ("--scene", "room.json", "--terrain", "slope:5"),
                          ("--scene", "room.json", "--object-shift", "0,0,0.1"),
                          ("--scene", "room.json", "--object-shift", "0,0"),
                          ("--scene", "room.json", "--terrain-scale", "z=9")):
            with self.subTest(arguments=arguments):
                result = self.run_tool("--bvh", "raised.bvh", *ROBOT, *arguments, "-o", "out.csv")
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertFalse((self.folder / "out.csv").exists())

    def test_a_scene_in_another_unit_causes_a_warning(self):
        self.write("raised.bvh", raised_clip())
        # In the clip's axes: centimetres, Y up.
        def in_clip(body):
            x, y, z = body.get("position", [0, 0, 0])
            shapes = []
            for shape in body["shapes"]:
                a, b, c = shape["size"]
                p, q, r = shape.get("position", [0, 0, 0])
                shapes.append({"type": "box", "size": [100 * a, 100 * c, 100 * b],
                               "position": [100 * p, 100 * r, -100 * q]})
            return {"name": body["name"], "position": [100 * x, 100 * z, -100 * y], "shapes": shapes}

        bodies = [in_clip(body) for body in ROOM["bodies"]]
        self.write("room.json", json.dumps(ROOM))
        self.write("clip.json", json.dumps({"bodies": bodies}))
        _, expected, plain = self.solve("--bvh", "raised.bvh", "--scene", "room.json")
        self.assertNotIn("touches nothing", plain.stderr)
        _, _, doubted = self.solve("--bvh", "raised.bvh", "--scene", "clip.json")
        self.assertIn("--scene-axes clip", doubted.stderr)
        _, found, good = self.solve("--bvh", "raised.bvh", "--scene", "clip.json", "--scene-axes",
                                    "clip")
        self.assertNotIn("--scene-axes", good.stderr)
        for a, b in zip(expected, found):
            for x, y in zip(a, b):
                self.assertAlmostEqual(x, y, delta=2e-3)

    def test_a_floor_that_stands_upright_causes_a_warning(self):
        # The clip in metres, Y up, and a slab below it in the same axes.
        head, motion = sample("squat").read_text().split("MOTION")
        head = [line.split() for line in head.splitlines()]
        head = [" ".join([w[0], *(str(float(x) / 100) for x in w[1:])] if w[0] == "OFFSET" else w)
                for w in head if w]
        motion = motion.splitlines()
        rows = [line.split() for line in motion[3:]]
        rows = [" ".join([*(str(float(x) / 100) for x in row[:3]), *row[3:]]) for row in rows]
        self.write("metres.bvh", "\n".join([*head, "MOTION", *motion[1:3], *rows, ""]))
        self.write("slab.json", json.dumps({"bodies": [
            {"name": "slab", "position": [0, -0.1, 0],
             "shapes": [{"type": "box", "size": [2, 0.2, 2]}]}]}))
        run = ("--bvh", "metres.bvh", *ROBOT, "--scene", "slab.json", "--end", "0.3", "-o", "out.csv")
        self.assertIn("stands on no body of the scene slab.json; it fits with --scene-axes clip",
                      self.run_tool(*run).stderr)
        self.assertNotIn("no body of the scene", self.run_tool(*run, "--scene-axes", "clip").stderr)

    def test_the_unit_of_the_clip_is_not_proposed_for_specks(self):
        # In centimetres the block in the way would be 5 mm long.
        self.write("block.json", json.dumps({"bodies": [
            {"name": "block", "position": [3, 0, 0.5],
             "shapes": [{"type": "box", "size": [0.5, 2, 1]}]}]}))
        result = self.run_tool("--bvh", sample("walk"), *ROBOT, "--scene", "block.json", "-o", "out.csv")
        self.assertIn('inside "block"', result.stderr)
        self.assertIn("check its unit", result.stderr)
        self.assertNotIn("--scene-axes", result.stderr)

    def test_batches_have_variations(self):
        arguments = ("batch", sample("walk"), "-o", "out", *ROBOT, "--terrain", "stairs:0.1x0.3",
                     "--variants", "2", "--seed", "5", "--end", "3")
        self.assert_done(self.run_tool(*arguments))
        lines = [json.loads(line)
                 for line in (self.folder / "out/manifest.jsonl").read_text().splitlines()]
        varied = {line["relative"]: line for line in lines if "changes" in line}
        self.assertEqual(sorted(varied), ["walk_v1.bvh", "walk_v2.bvh"])
        motions = set()
        for name in ("walk", "walk_v1", "walk_v2"):
            motions.add((self.folder / f"out/{name}.csv").read_bytes())
        self.assertEqual(len(motions), 3)
        # A variation is the run with the recorded options.
        terrain = varied["walk_v1.bvh"]["changes"].removeprefix("terrain=")
        self.assert_done(self.run_tool("--bvh", sample("walk"), *ROBOT, "--terrain", terrain,
                                       "--end", "3", "-o", "one.csv"))
        self.assertEqual((self.folder / "one.csv").read_bytes(),
                         (self.folder / "out/walk_v1.csv").read_bytes())
        again = self.run_tool(*arguments, "--resume")
        self.assert_done(again)
        self.assertEqual((self.folder / "one.csv").read_bytes(),
                         (self.folder / "out/walk_v1.csv").read_bytes())
        refused = self.run_tool("batch", sample("walk"), "-o", "none", *ROBOT, "--variants", "2")
        self.assertEqual(refused.returncode, 2, refused.stderr)

    def test_finds_the_scene_of_a_motion(self):
        self.write("step.bvh", stepping_clip())
        result = self.run_tool("scene-from-motion", "step.bvh", "-o", "boxes.json")
        self.assert_done(result)
        self.assertIn("step_1", result.stdout)
        step, = json.loads((self.folder / "boxes.json").read_text())["bodies"]
        self.assertAlmostEqual(step["shapes"][0]["size"][2], 0.2, delta=0.02)
        report, _, done = self.solve("--bvh", "step.bvh", "--scene", "boxes.json")
        self.assertGreater(report["scene_contact_pct"], 30.0)
        self.assertGreaterEqual(report["scene_contact_kept_pct"], 97.0)
        self.assertEqual(report["scene_pen_1cm_pct"], 0.0)
        self.assertNotIn("touches nothing", done.stderr)
        nothing = self.run_tool("scene-from-motion", sample("walk"), "-o", "none.json")
        self.assertEqual(nothing.returncode, 3, nothing.stderr)
        self.assertFalse((self.folder / "none.json").exists())
        # As in a run, noise of joint positions is removed first.
        noisy = noise.npy(noise.keypoints(noise.Motion(self.folder / "step.bvh"), white=0.01))
        self.write("noisy.npy", noisy)
        result = self.run_tool("scene-from-motion", "noisy.npy", "--source-fps", "30", "-o",
                               "noisy.json")
        self.assert_done(result)
        step, = json.loads((self.folder / "noisy.json").read_text())["bodies"]
        self.assertAlmostEqual(step["shapes"][0]["size"][2], 0.2, delta=0.02)
        wrong = self.run_tool("scene-from-motion", "step.bvh", "-o", "boxes.txt")
        self.assertEqual(wrong.returncode, 2, wrong.stderr)


if __name__ == "__main__":
    unittest.main()
