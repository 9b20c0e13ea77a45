"""FBX, glTF and MVNX in run, inspect, batch, convert and edit; other files."""

import csv
import json
import re
import struct
import unittest

from tool import SOURCE, ToolTest, read_rows, sample

DATA = SOURCE / "tests" / "scene" / "data"


# The joints of a sample as MVN's segments.
SEGMENTS = {"Hips": "Pelvis", "Spine": "L5", "Spine1": "L3", "Spine2": "T8", "Neck": "Neck", "Head": "Head",
            **{f"{side}{joint}": f"{side}{segment}" for side in ("Left", "Right") for joint, segment in (
                ("Shoulder", "Shoulder"), ("Arm", "UpperArm"), ("ForeArm", "ForeArm"), ("Hand", "Hand"),
                ("UpLeg", "UpperLeg"), ("Leg", "LowerLeg"), ("Foot", "Foot"), ("Toe", "Toe"))}}


def mvnx(joints, parents, rows):
    """Returns a document with the positions of `inspect --positions` (cm, Y up), in metres, Z up."""
    half = 0.5 ** 0.5
    connections = "".join(
        f"<joint><connector1>{SEGMENTS[parents[joint]]}/j</connector1><connector2>{SEGMENTS[joint]}/j</connector2></joint>"
        for joint in joints if parents[joint])
    frames = []
    for row in rows:
        turns, places = [], []
        for joint in joints:
            x, y, z = (0.01 * float(row[f"{joint}.{axis}"]) for axis in "xyz")
            places.append(f"{x:.6f} {-z:.6f} {y:.6f}")
            a, b, c, d = (float(row[f"{joint}.q{axis}"]) for axis in "wxyz")
            # A quarter turn about x comes first in the product.
            turns.append(" ".join(f"{half * value:.7f}" for value in (a - b, a + b, c - d, c + d)))
        frames.append(f'<frame type="normal"><orientation>{" ".join(turns)}</orientation>'
                      f'<position>{" ".join(places)}</position></frame>')
    return ('<?xml version="1.0"?>\n<mvnx version="4"><subject frameRate="30"><segments>' +
            "".join(f'<segment label="{SEGMENTS[joint]}"/>' for joint in joints) +
            f"</segments><joints>{connections}</joints><frames>{''.join(frames)}</frames></subject></mvnx>")


def with_second_actor(glb, name):
    """A GLB with a copy of all nodes, skins and animations; the copy's names begin with `name`."""
    length = struct.unpack_from("<I", glb, 12)[0]
    json_text, rest = glb[20:20 + length], glb[20 + length:]
    scene = json.loads(json_text)
    nodes, skins = len(scene["nodes"]), len(scene.get("skins", []))
    for node in scene["nodes"][:nodes]:
        copy = {key: value for key, value in node.items() if key not in ("mesh", "skin")}
        copy["name"] = name + node.get("name", "")
        copy["children"] = [child + nodes for child in node.get("children", [])]
        scene["nodes"].append({key: value for key, value in copy.items() if value != []})
    for skin in scene.get("skins", [])[:skins]:
        copy = {**skin, "joints": [joint + nodes for joint in skin["joints"]]}
        if "skeleton" in skin:
            copy["skeleton"] += nodes
        scene["skins"].append(copy)
    for animation in list(scene["animations"]):
        copy = json.loads(json.dumps(animation))
        copy["name"] = name + animation.get("name", "")
        for channel in copy["channels"]:
            channel["target"]["node"] += nodes
        scene["animations"].append(copy)
    for one in scene["scenes"]:
        one["nodes"] += [node + nodes for node in one["nodes"]]
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    return (glb[:8] + struct.pack("<I", 20 + len(text) + len(rest)) +
            struct.pack("<I4s", len(text), b"JSON") + text + rest)


class SceneFiles(ToolTest):
    def test_a_second_moving_actor_is_named_and_can_be_selected(self):
        self.write("two.glb", with_second_actor((DATA / "walk.glb").read_bytes(), "Bob_"))
        result = self.run_tool("two.glb", "g1", "-o", "first.csv")
        self.assert_done(result)
        hint = re.search(r'two.glb: warning: another skeleton moves: "(Bob_\S+)" '
                         r'\(take "(Bob_[^"]*)"\); --root NAME with --take NAME reads another skeleton',
                         result.stderr)
        self.assertTrue(hint, result.stderr)
        self.assertIn(hint[1], json.loads(self.run_tool("inspect", "two.glb", "--json").stdout)
                      ["warnings"][0]["message"])
        second = self.run_tool("two.glb", "g1", "-o", "second.csv", "--root", hint[1], "--take", hint[2])
        self.assert_done(second)
        # A requested skeleton needs no note.
        self.assertNotIn("another skeleton", second.stderr)
        self.assertEqual(*(((self.folder / name).read_bytes()) for name in
                           ("first.csv", "second.csv")))
        alone = self.run_tool(DATA / "walk.glb", "g1", "-o", "alone.csv")
        self.assertNotIn("another skeleton", alone.stderr)

    def test_mvnx_is_the_motion_that_it_was_made_of(self):
        found = json.loads(self.run_tool("inspect", sample("walk"), "--json").stdout)
        parents = {joint["name"]: joint["parent"] for joint in found["joints"]}
        places = self.run_tool("inspect", sample("walk"), "--positions", "-").stdout
        rows = list(csv.DictReader(places.splitlines()))
        self.write("walk.mvnx", mvnx(list(parents), parents, rows))
        result = self.run_tool("walk.mvnx", "g1", "-o", "mvnx.csv")
        self.assert_done(result)
        self.assertIn("xsens_mvn skeleton, unit m", result.stderr)
        self.assert_done(self.run_tool(sample("walk"), "g1", "-o", "bvh.csv"))
        ours, theirs = (read_rows((self.folder / name).read_text()) for name in ("mvnx.csv", "bvh.csv"))
        self.assertEqual(len(ours), len(theirs))
        root = max(abs(a - b) for one, two in zip(ours, theirs) for a, b in zip(one[:2], two[:2]))
        knees = max(abs(one[7 + joint] - two[7 + joint]) for one, two in zip(ours, theirs) for joint in (3, 9))
        self.assertLess(root, 0.05)
        self.assertLess(knees, 0.15)

    def test_runs(self):
        for name in ("walk.fbx", "walk.glb", "wave_z_up.fbx"):
            with self.subTest(name):
                result = self.run_tool(DATA / name, "g1", "-o", "out.csv")
                self.assert_done(result)
                self.assertEqual(len((self.folder / "out.csv").read_text().splitlines()), 11)
                self.assertIn("30 fps", result.stderr)
                self.assertIn('take "', result.stderr)

    def test_a_skeleton_without_a_skin_is_the_one_with_it(self):
        """One motion, without and with a skin: the robot does the same."""
        rows = []
        for name in ("walk.fbx", "walk.glb"):
            self.assert_done(self.run_tool(DATA / name, "g1", "-o", "out.csv"))
            rows.append(read_rows((self.folder / "out.csv").read_text()))
        joints = max(abs(a - b) for one, two in zip(*rows) for a, b in zip(one[7:], two[7:]))
        # Without a skin, the zero pose is a guess.
        self.assertLess(joints, 0.3)

    def test_inspect_lists_takes(self):
        result = self.run_tool("inspect", DATA / "takes.glb", "--take", "Squat")
        self.assert_done(result)
        self.assertIn('take "Squat" (', result.stdout)
        self.assertIn("1: ", result.stdout)
        found = json.loads(self.run_tool("inspect", DATA / "takes.glb", "--json").stdout)
        self.assertEqual(sorted(found["takes"]), ["Squat", "Wave"])

    def test_missing_takes_are_errors(self):
        result = self.run_tool(DATA / "walk.fbx", "g1", "-o", "out.csv", "--take", "9")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("(--take)", result.stderr)
        result = self.run_tool(sample("wave"), "g1", "-o", "out.csv", "--take", "1")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("contains one motion", result.stderr)

    def test_batch_finds_them(self):
        clips = self.folder / "clips"
        clips.mkdir()
        for name in ("walk.fbx", "takes.glb"):
            (clips / name.upper()).write_bytes((DATA / name).read_bytes())
        result = self.run_tool("batch", "clips", "-o", "out", "--robot", "g1", "--jobs", "1")
        self.assert_done(result)
        self.assertEqual(sorted(file.name for file in (self.folder / "out").glob("*.csv")),
                         ["TAKES.csv", "WALK.csv", "summary.csv"])

    def test_convert_and_edit(self):
        self.assert_done(self.run_tool("convert", DATA / "walk.fbx", "walk.glb"))
        self.assert_done(self.run_tool("edit", "mirror", DATA / "walk.fbx", "-o", "mirrored.bvh"))
        self.assert_done(self.run_tool("inspect", "mirrored.bvh"))
        # The written file can be read.
        again = json.loads(self.run_tool("inspect", "walk.glb", "--json").stdout)
        self.assertEqual(again["frames"], 11)

    def test_other_formats_are_named(self):
        headers = struct.pack("<BB", 2, 0x50) + bytes(600)
        usdz = b"PK\x03\x04" + bytes(22) + struct.pack("<HH", 9, 0) + b"body.usdc" + bytes(20)
        for name, content, words in (
                ("a.c3d", headers, "C3D file, which contains markers but no skeleton"),
                ("a.trc", b"PathFileType\t4\t(X/Y/Z)\ta.trc\n", "TRC file, which contains markers"),
                ("a.usda", b"#usda 1.0\n", "USD file"), ("a.usdc", b"PXR-USDC" + bytes(80), "USD file"),
                ("a.usdz", usdz, "USD archive"), ("a.abc", b"Ogawa\xff" + bytes(8), "Alembic"),
                ("a.blend", b"BLENDER-v300", "Blender"), ("b.blend", b"\x28\xb5\x2f\xfd1234", "zstd"),
                ("a.ma", b"//Maya ASCII 2024 scene\n", "Maya"), ("a.mb", b"FOR8\0\0\0\0", "Maya"),
                ("a.max", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(80), "3ds Max"),
                ("a.uasset", b"\xc1\x83\x2a\x9e" + bytes(80), "Unreal Engine")):
            with self.subTest(name):
                self.write(name, content)
                result = self.run_tool(name, "g1", "-o", "out.csv")
                self.assertEqual(result.returncode, 3, result.stderr)
                self.assertIn(words, result.stderr)
                self.assertIn("BVH", result.stderr.split("hint: ")[1])
                self.assertFalse((self.folder / "out.csv").exists())

    def test_hostile_files_are_refused(self):
        """An array that unpacks to a gigabyte; depth; a file cut off."""
        deep = '{"asset": {"version": "2.0"}, "nodes": [' + ",".join(
            '{"children": [%d]}' % (i + 1) for i in range(3000)) + ",{}]}"
        for name, content in (("cut.fbx", (DATA / "walk.fbx").read_bytes()[:5000]),
                              ("cut.glb", (DATA / "walk.glb").read_bytes()[:5000]),
                              ("deep.gltf", deep.encode()),
                              ("deep.json.gltf", b'{"asset": ' + b"[" * 100000),
                              ("empty.fbx", b"Kaydara FBX Binary  \0\x1a\0"),
                              ("empty.mvnx", b"<?xml version='1.0'?><mvnx/>")):
            with self.subTest(name):
                self.write(name, content)
                result = self.run_tool(name, "g1", "-o", "out.csv")
                self.assertEqual(result.returncode, 3, result.stderr)
                self.assertIn("error: ", result.stderr)


if __name__ == "__main__":
    unittest.main()
