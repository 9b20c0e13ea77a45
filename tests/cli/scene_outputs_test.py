"""Outputs of a run in a scene: the robot's world, tracks of objects, labels of contacts."""

import csv
import json
import unittest

from optional_numpy import numpy
from tool import ToolTest, absent, raised_clip, sample

FRAMES = 60
# The human squats on the step; a table and a moving crate are beside it.
SCENE = {
    "bodies": [
        {"name": "step", "position": [0.0, 0.0, 0.1],
         "shapes": [{"type": "box", "size": [2.0, 2.0, 0.2]}]},
        {"name": "table", "position": [2.0, 0.0, 0.35],
         "shapes": [{"type": "box", "size": [0.4, 0.4, 0.7]}]},
        {"name": "crate", "position": [1.5, 0.0, 0.5], "moves": True, "mass": 2.0,
         "shapes": [{"type": "box", "size": [0.3, 0.2, 0.2]}]},
    ]
}


class SceneOutputs(ToolTest):
    def setUp(self):
        super().setUp()
        if numpy is None:
            absent("NumPy is missing")
        self.write("raised.bvh", raised_clip())
        self.write("room.json", json.dumps(SCENE))
        rows = ["x,y,z,qw,qx,qy,qz"]
        rows += [f"{1.5 + 0.01 * i},0.0,0.5,1,0,0,0" for i in range(FRAMES)]
        self.write("crate.csv", "\n".join(rows) + "\n")

    def run_in_scene(self, *arguments):
        result = self.run_tool(
            "--bvh", "raised.bvh", "--robot", "unitree_g1", "--scene", "room.json",
            "--object-track", "crate=crate.csv", *arguments)
        self.assert_done(result)
        return result

    def path(self, name):
        return self.folder / name

    def test_world_of_the_robot(self):
        self.run_in_scene("-o", "squat.csv", "--scene-out", "world.json")
        world = json.loads(self.path("world.json").read_text())["bodies"]
        self.assertEqual([body["name"] for body in world], ["step", "table", "crate"])
        scale = world[1]["shapes"][0]["size"][2] / 0.7
        self.assertTrue(0.5 < scale < 1.0, scale)
        self.assertAlmostEqual(world[1]["position"][0], 2.0 * scale)
        # Objects keep their size; their lowest points have scaled heights.
        self.assertEqual(world[2]["shapes"][0]["size"], [0.3, 0.2, 0.2])
        self.assertAlmostEqual(world[2]["position"][2], 0.1 + 0.4 * scale)
        self.run_in_scene("-o", "squat.csv", "--scene-out", "world.xml")
        text = self.path("world.xml").read_text()
        self.assertIn('name="crate"', text)
        self.assertIn('type="free"', text)
        self.assertNotIn(str(self.folder), text)
        self.run_in_scene("-o", "squat.csv", "--scene-out", "world.obj")
        lines = self.path("world.obj").read_text().splitlines()
        self.assertEqual([line for line in lines if line.startswith("o ")], ["o step", "o table"])

    def test_mirror_images_include_the_scene(self):
        scene = json.loads(json.dumps(SCENE))
        scene["bodies"][1]["position"][1] = 0.8
        self.write("room.json", json.dumps(scene))
        rows = [f"1.5,{0.3 + 0.01 * i},0.5,1,0,0,0" for i in range(FRAMES)]
        self.write("crate.csv", "\n".join(["x,y,z,qw,qx,qy,qz", *rows]) + "\n")
        tables, paths = [], []
        for name, mirror in (("plain", ()), ("image", ("--mirror",))):
            self.run_in_scene("-o", f"{name}.npz", "--format", "npz-holosoma", "--scene-out",
                              f"{name}.json", *mirror)
            tables.append(json.loads(self.path(f"{name}.json").read_text())["bodies"][1]["position"])
            paths.append(numpy.load(self.path(f"{name}.npz"))["object_pos_w"])
        # The human faces x and stands near y = 0.
        self.assertGreater(tables[0][1], 0.3)
        self.assertAlmostEqual(tables[1][1], -tables[0][1], delta=0.02)
        self.assertAlmostEqual(tables[1][0], tables[0][0], delta=0.02)
        numpy.testing.assert_allclose(paths[1] * [1, -1, 1], paths[0], atol=0.02)

    def test_tracks_and_labels_in_npz(self):
        self.run_in_scene("-o", "squat.npz", "--format", "npz-holosoma")
        npz = numpy.load(self.path("squat.npz"))
        frames, joints = npz["joint_pos"].shape
        self.assertEqual(npz["object_names"].tolist(), ["crate"])
        self.assertEqual(npz["object_pos_w"].shape, (frames, 1, 3))
        self.assertEqual(npz["object_quat_w"].shape, (frames, 1, 4))
        qpos = npz["qpos"]
        self.assertEqual(qpos.shape, (frames, joints + 7))
        self.assertTrue((qpos[:, :joints] == npz["joint_pos"]).all())
        self.assertTrue((qpos[:, joints:joints + 3] == npz["object_pos_w"][:, 0]).all())
        speed = npz["object_lin_vel_w"][:, 0, 0]
        self.assertAlmostEqual(float(speed.std()), 0.0, delta=1e-3)
        self.assertAlmostEqual(float(speed.mean()),
                               0.3 * npz["object_pos_w"][0, 0, 0] / 1.5, delta=1e-3)
        labels = npz["contact_labels"]
        self.assertEqual(labels.shape, (frames, len(npz["contact_links"])))
        self.assertEqual(len(npz["contact_links"]), len(npz["contact_surfaces"]))
        self.assertTrue((labels >= 0).all() and (labels <= 1).all())
        self.assertEqual(labels.max(), 1.0)
        pairs = list(zip(npz["contact_links"], npz["contact_surfaces"]))
        foot = pairs.index(("left_ankle_roll_link", "step"))
        self.assertEqual(labels[frames // 2, foot], 1.0)

    def test_contacts(self):
        self.run_in_scene("-o", "squat.csv", "--contacts", "contacts.csv")
        with self.path("contacts.csv").open() as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), FRAMES)
        names = list(rows[0])
        self.assertEqual(names[:6],
                         ["frame", "time", "left_heel", "left_toe", "right_heel", "right_toe"])
        listed = self.run_tool(
            "contacts", "raised.bvh", "--robot", "unitree_g1", "--scene", "room.json",
            "--object-track", "crate=crate.csv", "--json", "-")
        self.assert_done(listed)
        contacts = json.loads(listed.stdout)
        self.assertEqual(contacts["frames"], FRAMES)
        self.assertIn(("left_heel", "step"),
                      {(one["part"], one["surface"]) for one in contacts["contacts"]})
        for contact in contacts["contacts"]:
            on_floor = contact["surface"] == "floor" and contact["part"] in names
            column = contact["part"] if on_floor else f"{contact['part']}:{contact['surface']}"
            for frame in range(contact["first"], contact["last"] + 1):
                self.assertEqual(rows[frame][column], "1")

    def test_without_a_scene_the_motion_is_unchanged(self):
        self.assert_done(self.run_tool("--bvh", sample("squat"), "--robot", "unitree_g1", "--frames",
                                       f"0:{FRAMES}", "-o", "squat.npz", "--format", "npz-mjlab"))
        names = set(numpy.load(self.path("squat.npz")).files)
        self.assertFalse({name for name in names if name.startswith(("object_", "contact_l"))})

    def test_errors(self):
        self.assert_fails(self.retarget("--scene-out", "x.xml", bvh=sample("squat")), 2, "--scene")
        self.assert_fails(self.retarget("--scene", "room.json", "--scene-out", "x.usd",
                                        bvh=sample("squat")), 2, ".xml, .json or .obj")


if __name__ == "__main__":
    unittest.main()
