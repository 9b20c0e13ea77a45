"""`--format glb`: valid files whose nodes match the kinematics."""

import json
import shutil
import unittest

import numpy as np

import gltf
from tool import ToolTest, absent, sample, short_clip


class GlbFiles(ToolTest):
    def assert_valid(self, path):
        folder, why_not = gltf.validator_folder()
        if folder is None and shutil.which("npm"):
            absent(why_not)
        elif folder is None:
            self.skipTest(why_not)
        found = [(m["severity"], m["code"], m.get("pointer")) for m in gltf.issues(path, folder)
                 if m["severity"] <= 1]
        self.assertEqual(found, [])

    def glb(self, name="out.glb"):
        return gltf.Glb(self.folder / name)

    def make(self, *options, robot="unitree_g1", frames=80):
        """A motion at 50 fps as GLB and tracking NPZ."""
        clip = self.write("walk.bvh", short_clip("walk", frames))
        self.assert_done(self.retarget("--method", "gmr", "--fps", 50, "--format", "glb,npz-mjlab",
                                       *options, bvh=clip, robot=robot, output="out"))
        return self.glb(), np.load(self.folder / "out.mjlab.npz")

    def assert_same_places(self, glb, tracking):
        frames, bodies = tracking["body_pos_w"].shape[:2]
        world = glb.world(frames)
        worst = 0.0
        for index in range(bodies):
            node = glb.node(str(tracking["body_names"][index]))
            places = gltf.z_up(world[node][1])
            worst = max(worst, np.abs(places - tracking["body_pos_w"][:, index]).max())
        self.assertLess(worst, 1e-5)
        self.assertEqual(bodies, len(tracking["body_names"]))

    def test_bodies_are_where_the_kinematics_put_them(self):
        glb, tracking = self.make()
        self.assert_same_places(glb, tracking)
        times = glb.times()
        self.assertEqual(len(times), len(tracking["body_pos_w"]) + 1)
        np.testing.assert_allclose(times, np.arange(len(times)) / 50, atol=1e-6)
        # Orientations as well: the pelvis, rotated from Y up, equals the tracker's.
        world = glb.world(len(times) - 1)
        w, x, y, z = tracking["body_quat_w"][:, 0].T
        up = gltf.matrix([-np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
        np.testing.assert_allclose(world[glb.node("pelvis")][0],
                                   up @ gltf.matrix(np.stack([x, y, z, w], -1)), atol=1e-5)

    def test_slides_anchors_and_bodies_without_a_parent(self):
        model = """<mujoco><worldbody><body name="base" pos="0 0 1"><freejoint/>
          <geom type="box" size=".1 .2 .3" mass="1"/>
          <body name="arm" pos="0 .2 .1" quat=".9 .1 .2 .3">
            <joint name="swing" axis="1 0 1" pos="0 -.05 .02" range="-1 2"/>
            <geom type="capsule" size=".04" fromto="0 0 0 0 .3 0" mass="1"/>
            <body name="rod" pos="0 .3 0">
            <joint name="push" type="slide" axis="0 1 0" range="-.2 .2"/>
              <geom size=".05" mass="1"/></body></body></body></worldbody></mujoco>"""
        self.write("machine.xml", model)
        rows = [f"0.1,0.2,{1 + 0.01 * i},0,0,0,1,{0.3 * np.sin(i / 5)},{0.1 * np.cos(i / 4)}"
                for i in range(40)]
        self.write("in.csv", "\n".join(rows) + "\n")
        self.assert_done(self.run_tool("convert", "in.csv", "out", "--robot-xml", "machine.xml",
                                       "--source-fps", 50, "--format", "glb,npz-mjlab"))
        self.assert_same_places(self.glb(), np.load(self.folder / "out.mjlab.npz"))
        self.assert_valid(self.folder / "out.glb")

    def test_rotations_interpolate_along_the_shorter_arc(self):
        glb, _ = self.make()
        animation = glb.json["animations"][0]
        for channel in animation["channels"]:
            if channel["target"]["path"] != "rotation":
                continue
            keys = glb.accessor(animation["samplers"][channel["sampler"]]["output"])
            self.assertTrue((np.sum(keys[1:] * keys[:-1], axis=1) >= 0).all())
            np.testing.assert_allclose(np.linalg.norm(keys, axis=1), 1, atol=1e-6)

    def test_the_human_is_a_skin_at_its_own_position(self):
        glb, _ = self.make()
        self.assert_done(self.run_tool("inspect", "walk.bvh", "--positions", "places.csv"))
        names = (self.folder / "places.csv").read_text().splitlines()[0].split(",")
        places = np.loadtxt(self.folder / "places.csv", delimiter=",", skiprows=1)
        joints = glb.json["skins"][0]["joints"]
        # The clip runs at 30 frames per second, the motion at 50: both have the times 0, 0.1, 0.2, ...
        world = glb.world(len(glb.times()))
        for joint in joints:
            name = glb.nodes[joint]["name"]
            columns = [names.index(f"{name}.{axis}") for axis in "xyz"]
            # Centimetres in the file; its axes, Y up, match glTF.
            wanted = 0.01 * places[::3][:, columns]
            found = world[joint][1][::5][:len(wanted)]
            np.testing.assert_allclose(found, wanted[:len(found)], atol=1e-5)
        # At rest, the inverse bind matrix of every joint cancels its pose.
        bind = glb.accessor(glb.json["skins"][0]["inverseBindMatrices"]).reshape(-1, 4, 4)
        for joint, inverse in zip(joints, bind):
            place, index = np.zeros(3), joint
            while glb.nodes[index]["name"] != "human":
                place = place + glb.nodes[index]["translation"]
                index = glb.parents[index]
            np.testing.assert_allclose(inverse[3, :3], -place, atol=1e-6)

    def test_runs_converted_and_edited_files_are_valid(self):
        self.make()
        self.assert_valid(self.folder / "out.glb")
        self.assert_done(self.run_tool("convert", "out.mjlab.npz", "of_npz.glb", "--robot", "g1"))
        self.assert_valid(self.folder / "of_npz.glb")
        self.assertNotIn("skins", self.glb("of_npz.glb").json)
        self.assert_done(self.run_tool("edit", "mirror", "walk.bvh", "-o", "mirrored.GLB"))
        self.assert_valid(self.folder / "mirrored.GLB")
        self.assert_done(self.run_tool("convert", "walk.bvh", "human.glb"))
        self.assert_valid(self.folder / "human.glb")
        self.assert_done(self.run_tool("convert", "walk.bvh", "-o", "again", "--format", "glb"))
        human = self.glb("human.glb").json
        self.assertEqual([s["name"] for s in human["skins"]], ["human"])
        self.assertEqual(human["animations"][0]["name"], "human")

    def test_robots_are_not_taken_for_humans(self):
        self.make()
        for command in (("out.glb", "g1", "-o", "again.csv"), ("inspect", "out.glb"),
                        ("edit", "mirror", "out.glb", "-o", "mirrored.bvh")):
            with self.subTest(command=command):
                self.assert_fails(self.run_tool(*command), 3, "shows the robot unitree_g1",
                                  "such as walk.csv")
        # The human alone has no such mark.
        self.assert_done(self.run_tool("convert", "walk.bvh", "human.glb"))
        self.assert_done(self.run_tool("inspect", "human.glb"))

    def test_meshes_are_closed_and_look_outwards(self):
        glb, _ = self.make()
        for mesh in glb.json["meshes"]:
            for primitive in mesh["primitives"]:
                points = glb.accessor(primitive["attributes"]["POSITION"]).astype(float)
                normals = glb.accessor(primitive["attributes"]["NORMAL"]).astype(float)
                corners = glb.accessor(primitive["indices"]).reshape(-1, 3)
                a, b, c = (points[corners[:, i]] for i in range(3))
                faces = np.cross(b - a, c - a)
                self.assertTrue((np.sum(faces * normals[corners].mean(axis=1), axis=1) > 0).all())
                self.assertLess(np.abs(faces.sum(axis=0)).max(), 1e-6)

    def test_the_name_chooses_the_format_and_bytes_repeat(self):
        clip = self.write("walk.bvh", short_clip("walk", 40))
        for name in ("a.glb", "b.glb"):
            self.assert_done(self.retarget("--method", "gmr", "--sidecar", bvh=clip, output=name))
        self.assertEqual(self.glb("a.glb").json["animations"][0]["name"], "a")
        self.assert_done(self.run_tool("verify", "a.glb.json"))
        self.assert_done(self.retarget("--method", "gmr", "--format", "glb", bvh=clip, output="-",
                                       errors="replace"))
        self.assert_fails(self.retarget("--format", "csv", bvh=clip, output="c.glb"), 2, ".glb")
        self.assert_fails(self.run_tool("convert", "a.glb", "c.csv", "--robot", "g1"), 3, "GLB")
        self.assert_fails(self.run_tool("convert", "walk.bvh", "c.csv"), 2, "--robot")
        self.write("motion.csv", "1,2,3\n")
        self.assert_fails(self.run_tool("convert", "motion.csv", "c.glb"), 3, "--robot")

    def test_a_motion_that_starts_at_the_origin_takes_the_human_along(self):
        clip = self.write("walk.bvh", short_clip("walk", 60))
        options = ("--method", "gmr", "--start", 1)
        self.assert_done(self.retarget(*options, bvh=clip, output="a.glb"))
        self.assert_done(self.retarget(*options, "--normalize-start", bvh=clip, output="b.glb"))
        between = []
        for name in ("a.glb", "b.glb"):
            glb = self.glb(name)
            world = glb.world(len(glb.times()))
            between.append(np.linalg.norm(world[glb.node("pelvis")][1]
                                          - world[glb.node("Hips")][1], axis=1))
        np.testing.assert_allclose(between[0], between[1], atol=1e-5)

    def test_unusual_names_round_trip(self):
        model = """<mujoco><worldbody><body name='a"b&lt;c&gt;é'><freejoint/><geom size=".1"/>
          <body name="arm"><joint name="a"/><geom size=".1"/></body></body></worldbody></mujoco>"""
        self.write("odd.xml", model)
        self.write("in.csv", "0,0,0.15,0,0,0,1,0.5\n" * 3)
        self.assert_done(self.run_tool("convert", "in.csv", "<odd>.glb", "--robot-xml", "odd.xml"))
        glb = self.glb("<odd>.glb")
        self.assertIn('a"b<c>é', [node["name"] for node in glb.nodes])
        self.assertEqual(glb.json["animations"][0]["name"], "<odd>")


if __name__ == "__main__":
    unittest.main()
