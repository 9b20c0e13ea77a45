"""Scenes on pages of `retarget view` and `--html`: data of the files, and bodies in a headless browser."""

import json
import pathlib
import unittest

import numpy as np

from pages import data_of, tracks_of
from pages_in_browser import PagesInABrowser
from tool import ToolTest, raised_clip

FRAMES, CLIP_FPS = 60, 30
# The human squats on a step of 20 cm. A mesh is beside it, and a crate moves and turns.
SCENE = {
    "bodies": [
        {"name": "step", "position": [0.0, 0.0, 0.1],
         "shapes": [{"type": "box", "size": [1.2, 1.0, 0.2]}]},
        {"name": "wedge", "position": [0.4, -0.9, 0.0],
         "shapes": [{"type": "mesh", "vertices": [[0, 0, 0], [0.4, 0, 0], [0, 0.3, 0], [0, 0, 0.5]],
                     "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]},
                    {"type": "cylinder", "radius": 0.05, "length": 0.4, "position": [0.6, 0, 0.2]}]},
        {"name": "crate", "position": [0.9, 0.0, 0.1], "moves": True,
         "shapes": [{"type": "box", "size": [0.3, 0.2, 0.2]}]},
    ]
}
IN_SCENE = ("--scene", "room.json", "--object-track", "crate=crate.csv")
SHOWN = (0, 45)


def write_scene_files(test):
    """The clip, the scene and the track, in the folder of the test."""
    test.write("raised.bvh", raised_clip())
    test.write("room.json", json.dumps(SCENE))
    rows = ["x,y,z,qw,qx,qy,qz"]
    for i in range(FRAMES):
        half = 0.01 * i
        rows.append(f"{0.9 + 0.01 * i},0,0.1,{np.cos(half)},0,0,{np.sin(half)}")
    test.write("crate.csv", "\n".join(rows) + "\n")


def run_in_scene(test, *arguments):
    test.assert_done(
        test.run_tool("--bvh", "raised.bvh", "--robot", "unitree_g1", *IN_SCENE, *arguments))


class SceneOnAPage(ToolTest):
    """Without a browser."""

    def setUp(self):
        super().setUp()
        write_scene_files(self)

    def page(self, name):
        return (self.folder / name).read_text()

    def view(self, output, *arguments):
        result = self.run_tool("view", *arguments, "--robot", "unitree_g1", "-o", output)
        self.assert_done(result)
        return result

    def test_a_file_shows_the_scene_of_its_run(self):
        run_in_scene(self, "-o", "squat.csv", "--html", "run.html", "--scene-out", "world.json")
        ran = data_of(self.page("run.html"))[0]
        [scene] = ran["scenes"]
        self.assertEqual([body["name"] for body in scene["bodies"]], ["step", "wedge", "crate"])
        world = json.loads((self.folder / "world.json").read_text())["bodies"]
        for body, pose in zip(world[:2], scene["robot"]["poses"]):
            self.assertLess(
                np.abs(np.subtract(body["position"] + body["quaternion"], pose)).max(), 1e-9)
        crate = tracks_of(self.page("run.html"))[scene["robot"]["position"]]
        self.assertEqual(crate.shape, (FRAMES, 3))
        self.assertLess(np.abs(crate[0] - world[2]["position"]).max(), 6e-5)
        # The human's world is the scene of the file.
        self.assertEqual(scene["human"]["poses"][0][:3], SCENE["bodies"][0]["position"])
        touches = ran["motions"][0]["touches"]
        self.assertIn(("left_heel", "step"), {(each["part"], each["surface"]) for each in touches})
        # Other contacts are with the floor, which has rows of its own.
        self.assertNotIn("floor", {each["surface"] for each in touches})
        self.view("later.html", "squat.csv", "--bvh", "raised.bvh", *IN_SCENE)
        later = data_of(self.page("later.html"))[0]
        self.assertEqual(later["scenes"][0]["bodies"], scene["bodies"])
        self.assertEqual(later["scenes"][0]["robot"]["poses"], scene["robot"]["poses"])
        self.assertEqual(later["motions"][0]["touches"], touches)

    def test_motions_of_one_source_share_a_scene(self):
        run_in_scene(self, "-o", "squat.csv")
        (self.folder / "again.csv").write_bytes((self.folder / "squat.csv").read_bytes())
        self.view("two.html", "squat.csv", "again.csv", "--bvh", "raised.bvh", *IN_SCENE)
        header = data_of(self.page("two.html"))[0]
        self.assertEqual(len(header["scenes"]), 1)
        self.assertEqual([each["scene"] for each in header["motions"]], [0, 0])

    def test_without_a_source_the_scene_is_as_in_its_file(self):
        run_in_scene(self, "-o", "squat.npz", "--format", "npz-holosoma", "--scene-out", "world.json")
        self.view("alone.html", "squat.npz", "--scene", "world.json",
                  "--object-track", "crate=squat.npz")
        page = self.page("alone.html")
        [scene] = data_of(page)[0]["scenes"]
        self.assertNotIn("human", scene)
        motion = np.load(self.folder / "squat.npz")
        drawn = tracks_of(page)[scene["robot"]["position"]]
        self.assertLess(np.abs(drawn - motion["object_pos_w"][:, 0]).max(), 1e-4)

    def test_without_a_scene_there_is_no_trace_of_one(self):
        run_in_scene(self, "-o", "squat.csv")
        self.view("plain.html", "squat.csv", "--bvh", "raised.bvh")
        header = data_of(self.page("plain.html"))[0]
        self.assertNotIn("scenes", header)
        self.assertFalse({"scene", "touches"} & header["motions"][0].keys())

    def test_a_scene_too_large_for_a_page_is_left_out(self):
        count = 300001
        vertices = "".join(f"v {i % 7} {i % 5} {0.001 * (i % 3)}\n" for i in range(105))
        faces = "".join(f"f {1 + i % 105} {1 + (i + 1) % 105} {1 + (i + 3) % 105}\n"
                        for i in range(count))
        self.write("large.obj", vertices + faces)
        run_in_scene(self, "-o", "squat.csv")
        result = self.view("large.html", "squat.csv", "--scene", "large.obj")
        self.assertIn("omitted from the page: ", result.stderr)
        self.assertIn("at most 300000 fit on a page", result.stderr)
        self.assertNotIn("scenes", data_of(self.page("large.html"))[0])

    def test_wrong_calls(self):
        run_in_scene(self, "-o", "squat.csv")
        view = ("view", "squat.csv", "--robot", "unitree_g1", "-o", "page.html")
        self.assert_fails(self.run_tool(*view, "--object-track", "crate=crate.csv"), 2,
                          "--object-track requires --scene")
        self.assert_fails(self.run_tool(*view, "--scene", "none.json"), 3, "none.json")
        self.assert_fails(
            self.run_tool(*view, "--scene", "room.json", "--object-track", "box=crate.csv"), 3, "box")
        self.assertFalse((self.folder / "page.html").exists())


class SceneInABrowser(PagesInABrowser):
    def make_pages(self):
        write_scene_files(self)
        run_in_scene(self, "-o", "squat.npz", "--format", "npz-holosoma", "--html", "run.html",
                     "--scene-out", "world.json")

    def press_button(self, text):
        self.run_script(
            "[...document.querySelectorAll('#view-tools button')]"
            f".find((each) => each.textContent === {json.dumps(text)}).click()")

    def scene(self, call="scene"):
        return {each["name"]: each for each in self.run_script(f"retarget.{call}(0)")}

    def test_bodies_are_where_the_robots_world_has_them(self):
        self.open("run.html")
        world = {
            each["name"]: each
            for each in json.loads((self.pages / "world.json").read_text())["bodies"]
        }
        motion = np.load(pathlib.Path(self.pages) / "squat.npz")
        for frame in SHOWN:
            self.run_script(f"retarget.show({frame})")
            drawn = self.scene()
            self.assertEqual(drawn.keys(), {"step", "wedge", "crate"})
            for name in ("step", "wedge"):
                self.assert_near(drawn[name]["position"], world[name]["position"], 1e-6)
                self.assert_near(drawn[name]["quaternion"], world[name]["quaternion"], 1e-6)
            self.assert_near(drawn["crate"]["position"], motion["object_pos_w"][frame, 0], 1e-4)
            turn = motion["object_quat_w"][frame, 0]
            sign = np.sign(np.dot(turn, drawn["crate"]["quaternion"]))
            self.assert_near(sign * np.array(drawn["crate"]["quaternion"]), turn, 1e-4)
        self.assert_quiet("run.html")

    def test_the_human_has_its_own_world(self):
        self.open("run.html")
        # The track has the frames of the clip.
        step = 0.01 * CLIP_FPS / self.run_script("retarget.motions[0].fps")
        for frame in SHOWN:
            self.run_script(f"retarget.show({frame})")
            drawn = self.scene("humanScene")
            self.assert_near(drawn["step"]["position"], SCENE["bodies"][0]["position"], 1e-6)
            self.assert_near(drawn["crate"]["position"], [0.9 + step * frame, 0, 0.1], 1e-4)
            # The step has the size of the file, the crate has it in both worlds.
            robot = self.scene()
            # Read back from matrices, so equal up to rounding.
            self.assertAlmostEqual(drawn["crate"]["scale"], robot["crate"]["scale"], delta=1e-12)
            scale = robot["step"]["position"][2] / drawn["step"]["position"][2]
            self.assertAlmostEqual(drawn["step"]["scale"], 1 / scale, delta=1e-6)
        # Over the robot, the human is in the robot's world.
        self.press_button("Over")
        self.assertEqual(self.scene("humanScene"), {})
        self.assertEqual(len(self.scene()), 3)

    def test_a_button_hides_the_scene(self):
        self.open("run.html")
        self.press_button("Scene")
        self.assertEqual(self.scene(), {})
        self.assertEqual(self.scene("humanScene"), {})
        self.press_button("Scene")
        self.assertEqual(len(self.scene()), 3)
        self.assert_quiet("run.html")

    def test_contacts_with_bodies_have_rows(self):
        self.open("run.html")
        rows = self.run_script(
            "[...document.querySelectorAll('#lanes .name')]"
            ".map((each) => [each.textContent, each.title])")
        titles = dict(rows)
        self.assertIn("Left foot: step", titles)
        self.assertIn("left_heel:step", titles["Left foot: step"])
        self.assertIn("left_toe:step", titles["Left foot: step"])

    def assert_near(self, found, expected, tolerance):
        self.assertLess(np.abs(np.subtract(found, expected)).max(), tolerance)


if __name__ == "__main__":
    unittest.main()
