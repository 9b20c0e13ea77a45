"""Makes the seeds of tests/fuzz/seeds of formats other than settings: motions of two or three frames.

    RETARGET_TOOL=build/release/tools/retarget/retarget python3 tests/fuzz/make_seeds.py
"""

import base64
import gzip
import io
import json
import os
import pathlib
import pickle
import struct
import subprocess
import sys
import tempfile
import zipfile
import zlib

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "cli"))
import torch_writer  # noqa: E402
SEEDS = ROOT / "tests" / "fuzz" / "seeds"
TOOL = pathlib.Path(os.environ["RETARGET_TOOL"]).resolve()


def write(target, name, content):
    """Writes a seed, text or bytes."""
    folder = SEEDS / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)


def npz(arrays, compress=False):
    """An NPZ file with the same bytes in every run."""
    out = io.BytesIO()
    kind = zipfile.ZIP_DEFLATED if compress else zipfile.ZIP_STORED
    with zipfile.ZipFile(out, "w", kind) as archive:
        for name, array in arrays.items():
            archive.writestr(zipfile.ZipInfo(name + ".npy"), npy(array), kind)
    return out.getvalue()


def npy(array):
    """An NPY file."""
    out = io.BytesIO()
    np.save(out, np.asarray(array))
    return out.getvalue()


def short_bvh(name, frames):
    """A sample of the repository, cut."""
    head, motion = (ROOT / "data" / name).read_text().split("MOTION\n")
    lines = motion.splitlines()
    rows = lines[2:2 + frames]
    return f"{head}MOTION\nFrames: {len(rows)}\nFrame Time: 0.033333\n" + "\n".join(rows) + "\n"


def renamed(text):
    """The same body with the names of another skeleton profile."""
    for old, new in (("LeftUpLeg", "lThigh"), ("LeftLeg", "lShin"), ("LeftFoot", "lFoot"), ("LeftToe", "lToe"),
                     ("RightUpLeg", "rThigh"), ("RightLeg", "rShin"), ("RightFoot", "rFoot"), ("RightToe", "rToe"),
                     ("LeftShoulder", "lCollar"), ("LeftArm", "lShldr"), ("LeftForeArm", "lForeArm"),
                     ("LeftHand", "lHand"), ("RightShoulder", "rCollar"), ("RightArm", "rShldr"),
                     ("RightForeArm", "rForeArm"), ("RightHand", "rHand"), ("Hips", "hip"), ("Spine2", "chest"),
                     ("Spine1", "abdomen2"), ("Spine", "abdomen"), ("Neck", "neck"), ("Head", "head")):
        text = text.replace(old, new)
    return text


def lines_of_bvh():
    """Whole bodies, for the way to a robot."""
    write("line", "walk.bvh", short_bvh("walk.bvh", 3))
    write("line", "one_frame.bvh", short_bvh("squat.bvh", 1))
    write("line", "other_names.bvh", renamed(short_bvh("wave.bvh", 2)))
    nameless = short_bvh("turn_in_place.bvh", 2)
    for number, word in enumerate(sorted({line.split()[-1] for line in nameless.splitlines()
                                          if line.strip().startswith(("ROOT", "JOINT"))}, key=lambda word: (-len(word), word))):
        nameless = nameless.replace(f" {word}\n", f" j{number}\n")
    write("line", "no_names.bvh", nameless)
    write("bvh", "walk.bvh", short_bvh("walk.bvh", 2))


def arrays():
    """NPY, NPZ and SMPL."""
    kinds = {"doubles": np.arange(6.0).reshape(2, 3), "floats": np.float32([[1.5], [2.5]]), "bytes": np.uint8([1, 2]),
             "big_endian": np.array([1.0, -2.0], ">f8"), "columns": np.asfortranarray(np.arange(6).reshape(3, 2)),
             "text": np.array(["male", "b"]), "letters": np.array([b"abc"]), "truth": np.array([True, False]),
             "scalar": np.array(30.0), "nothing": np.zeros((0, 3)), "halves": np.float16([0.5, -1.0])}
    for name, array in kinds.items():
        write("npy", name + ".npy", npy(array))
    write("npz", "stored.npz", npz(kinds))
    write("npz", "packed.npz", npz({name: kinds[name] for name in ("doubles", "text")}, compress=True))
    motion = {"poses": np.zeros((2, 66)), "trans": np.zeros((2, 3)), "betas": np.zeros(10), "gender": np.array("male"),
              "mocap_framerate": np.array(30.0)}
    motion["poses"][:, 0] = np.pi / 2
    write("smpl", "amass.npz", npz(motion, compress=True))
    parts = {"root_orient": motion["poses"][:, :3], "pose_body": motion["poses"][:, 3:], "trans": motion["trans"],
             "fps": np.array([30])}
    write("smpl", "parts.npz", npz(parts, compress=True))
    for name in ("poses", "trans", "betas", "gender"):
        write("smpl_arrays", name + ".npy", npy(motion[name]))
    write("smpl_arrays", "fps.npy", npy(30.0))
    body = standing()
    write("smpl", "joints.npy", npy(np.stack([body, body + .01])))
    write("smpl", "mdm.npy", npy(np.stack([body, body + .01]).transpose(1, 2, 0)[None]))
    results = io.BytesIO()
    np.save(results, {"motion": np.float32(np.stack([body, body]).transpose(1, 2, 0)[None]), "lengths": np.array([2]),
                      "text": ["stands"]}, allow_pickle=True)
    write("smpl", "results.npy", results.getvalue())
    write("smpl", "kimodo.npz", npz({"posed_joints": np.float32(body[None]),
                                     "global_rot_mats": np.float32(np.tile(np.eye(3), (1, 22, 1, 1)))}, compress=True))
    write("smpl_arrays", "joints.npy", npy(np.stack([body, body])))
    write("smpl_arrays", "joint_names.npy", npy(np.array(["left_hip", "right_hip", "left_knee"])))


def standing():
    """SMPL's 22 joints in a T-pose, metres, Y up."""
    return np.array([[0, 0, 0], [.09, -.08, 0], [-.09, -.08, 0], [0, .11, 0], [.09, -.46, .02], [-.09, -.46, .02],
                     [0, .25, 0], [.09, -.87, 0], [-.09, -.87, 0], [0, .31, 0], [.09, -.92, .12], [-.09, -.92, .12],
                     [0, .52, 0], [.07, .43, 0], [-.07, .43, 0], [0, .62, 0], [.18, .45, 0], [-.18, .45, 0],
                     [.44, .45, 0], [-.44, .45, 0], [.68, .45, .05], [-.68, .45, .05]])


def body_model():
    """A miniature body model: one vertex per joint, one above and one below."""
    parents = [-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19]
    heights = [0, -.1, -.1, .1, -.5, -.5, .25, -.9, -.9, .3, -.95, -.95, .5, .45, .45, .6, .45, .45, .45, .45, .45, .45]
    sides = [0, .1, -.1, 0, .1, -.1, 0, .1, -.1, 0, .1, -.1, 0, .1, -.1, 0, .2, -.2, .45, -.45, .7, -.7]
    joints = np.stack([np.array(sides), np.array(heights), np.zeros(22)], axis=1)
    vertices = np.concatenate([joints, [[0, .75, 0], [.1, -1.0, .1], [-.1, -1.0, .1], [.85, .45, 0], [-.85, .45, 0]]])
    regressor = np.concatenate([np.eye(22), np.zeros((22, 5))], axis=1)
    for count, kind in ((22, "body"), (52, "hands")):
        more = count - 22
        tree = np.array([[*[max(p, -1) for p in parents], *[20] * more], np.arange(count)])
        write("smpl_body", kind + ".npz", npz({
            "v_template": np.float32(vertices), "shapedirs": np.zeros((27, 3, 2), np.float32),
            "J_regressor": np.float32(np.concatenate([regressor, np.tile(regressor[20], (more, 1))])),
            "kintree_table": tree}, compress=True))


def pickles():
    """Pickles of every protocol, of NumPy, and rejected ones."""
    values = {"fps": 30, "doubles": np.arange(6.0).reshape(2, 3), "names": ["a", "b"], "none": None, "true": True,
              "far": -5_000_000_000, "huge": 1 << 70, "tuple": (1.5, b"bytes"), "scalar": np.float64(2.5)}
    for protocol in range(6):
        write("pickle", f"protocol_{protocol}.pkl", pickle.dumps(values, protocol))
    tensor = (b"\x80\x02}X\x08\x00\x00\x00root_posctorch._utils\n_rebuild_tensor_v2\n"
              b"((X\x07\x00\x00\x00storagectorch\nFloatStorage\nX\x01\x00\x00\x000X\x03\x00\x00\x00cpuK\x06tQ"
              b"K\x00K\x02K\x03\x86K\x03K\x01\x86\x89ccollections\nOrderedDict\n)RtRs.")
    write("pickle", "torch_tensor.pkl", tensor)
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as out:
        out.writestr(zipfile.ZipInfo("motion/data.pkl"), tensor)
        out.writestr(zipfile.ZipInfo("motion/data/0"), np.float32(np.arange(6)).tobytes())
        out.writestr(zipfile.ZipInfo("motion/version"), "3\n")
    write("motion", "torch.pt", archive.getvalue())
    write("pickle", "zlib.joblib", zlib.compress(pickle.dumps(values, 4)))
    write("pickle", "gzip.joblib", gzip.compress(pickle.dumps(values, 4), mtime=0))


def meshes():
    """A box as STL of both kinds, and as OBJ with all ways to name a corner."""
    corners = [[0.1 * (i >> axis & 1) for axis in range(3)] for i in range(8)]
    faces = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    triangles = [each for a, b, c, d in faces for each in ((a, b, c), (a, c, d))]
    packed = b"".join(struct.pack("<12fH", 0, 0, 0, *(v for i in each for v in corners[i]), 0) for each in triangles)
    write("mesh", "box.stl", bytes(80) + struct.pack("<I", len(triangles)) + packed)
    loops = "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*corners[i]) for i in each) +
                    "endloop\nendfacet\n" for each in triangles)
    write("mesh", "text.stl", f"solid box\n{loops}endsolid\n".encode())
    points = "".join("v {} {} {}\n".format(*corner) for corner in corners)
    write("mesh", "box.obj", f"# box\n{points}vn 0 0 1\nf 1//1 3//1 4 2/1/1\nf -8 -7 -3\n".encode())
def torch_files():
    """GVHMR's form, InterMimic's, a dictionary like an NPZ, and what is refused; as files and as
    the pickles in them (whose storages the target has)."""
    motion = {"root_orient": np.zeros((2, 3), "f4"), "pose_body": np.zeros((2, 63), "f4"),
              "trans": np.zeros((2, 9), "f4")[:, 3:6], "gender": "male", "fps": 30}
    world = {"global_orient": motion["root_orient"], "body_pose": motion["pose_body"],
             "transl": np.zeros((3, 2), "f4").T, "betas": np.zeros((2, 10), "f4")}
    evil = torch_writer.named("os", "system") + b"(X\x02\x00\x00\x00idtR"
    small = {"poses": np.zeros((1, 99), "f4")[:, :66], "trans": np.zeros((33, 3), "f4")[:1], "fps": 30.0}
    rows = np.zeros((2, 591), "f4")
    rows[:, 6] = 1
    for name, value in (("motion", motion), ("gvhmr", {"smpl_params_global": world}), ("evil", evil),
                        ("intermimic", rows), ("weights", {"a": np.zeros(3, "f2"), "b": [1, None]})):
        write("torch", name + ".pt", torch_writer.torch_bytes(value))
    for name, value in (("small", small), ("tensor", np.zeros((3, 33), "f4")), ("evil", evil)):
        write("torch", name + ".pkl", torch_writer.TorchPickle().value(value) + b".")


FBX_SECOND = 46186158000


def fbx_tree():
    """A file of two limbs and a take, as (name, values, children)."""
    def row(name, kind, *values):
        return ("P", [name, kind, "", "A", *values], [])

    def properties(*rows):
        return ("Properties70", [], list(rows))

    objects, links = [], []
    for number, name, parent, place in ((10, "Hips", 0, (0.0, 90.0, 0.0)), (11, "Leg", 10, (9.0, -5.0, 0.0))):
        objects.append(("Model", [number, f"{name}\0\1Model", "LimbNode"], [
            ("Version", [232], []),
            properties(row("Lcl Translation", "Lcl Translation", *place), row("RotationActive", "bool", 1),
                       row("PreRotation", "Vector3D", 10.0, 20.0, 30.0), row("RotationOrder", "enum", 4))]))
        objects.append(("NodeAttribute", [number + 10, f"{name}\0\1NodeAttribute", "LimbNode"],
                        [("TypeFlags", ["Skeleton"], [])]))
        links += [("C", ["OO", number, parent], []), ("C", ["OO", number + 10, number], [])]
    objects += [("AnimationStack", [30, "Take\0\1AnimStack", ""],
                 [properties(row("LocalStop", "KTime", FBX_SECOND))]),
                ("AnimationLayer", [31, "Base\0\1AnimLayer", ""], []),
                ("AnimationCurveNode", [32, "R\0\1AnimCurveNode", ""], [properties(row("d|X", "Number", 0.0))]),
                ("AnimationCurve", [33, "\0\1AnimCurve", ""],
                 [("Default", [0.0], []), ("KeyVer", [4008], []),
                  ("KeyTime", [np.arange(3, dtype=np.int64) * (FBX_SECOND // 30)], []),
                  ("KeyValueFloat", [np.float32([0, 20, 40])], []), ("KeyAttrFlags", [np.int32([4])], []),
                  ("KeyAttrDataFloat", [np.float32([0, 0, 0, 0])], []), ("KeyAttrRefCount", [np.int32([3])], [])])]
    links += [("C", ["OO", 31, 30], []), ("C", ["OO", 32, 31], []), ("C", ["OP", 32, 10, "Lcl Rotation"], []),
              ("C", ["OP", 33, 32, "d|X"], [])]
    settings = [properties(row("UpAxis", "int", 1), row("UnitScaleFactor", "double", 1.0), row("TimeMode", "enum", 6))]
    return [("FBXHeaderExtension", [], [("FBXVersion", [7400], [])]), ("GlobalSettings", [], settings),
            ("Objects", [], objects), ("Connections", [], links)]


def fbx_text(tree, depth=0):
    """The tree as FBX's text."""
    def value_text(value):
        if isinstance(value, str):
            return '"' + "::".join(reversed(value.split("\0\1"))) + '"'
        if isinstance(value, np.ndarray):
            return f"*{len(value)} {{ a: {','.join(map(str, value.tolist()))} }}"
        return str(value)

    lines = [] if depth else ["; FBX 7.4.0 project file"]
    for name, values, children in tree:
        line = "\t" * depth + f"{name}: " + ",".join(map(value_text, values))
        if children or name in ("Objects", "Connections"):
            lines += [line + " {", fbx_text(children, depth + 1), "\t" * depth + "}"]
        else:
            lines.append(line)
    return "\n".join(lines) + ("" if depth else "\n")


def fbx_bytes(tree, packed):
    """The tree as FBX's binary form; packed: arrays are deflated."""
    def value_bytes(value):
        if isinstance(value, str):
            return b"S" + struct.pack("<I", len(value.encode())) + value.encode()
        if isinstance(value, np.ndarray):
            kind = {"int64": b"l", "int32": b"i", "float32": b"f"}[str(value.dtype)]
            content = zlib.compress(value.tobytes()) if packed else value.tobytes()
            return kind + struct.pack("<III", len(value), int(packed), len(content)) + content
        return b"D" + struct.pack("<d", value) if isinstance(value, float) else b"L" + struct.pack("<q", value)

    def node_bytes(node, at):
        name, values, children = node
        head = b"".join(map(value_bytes, values))
        body = head
        for child in children:
            body += node_bytes(child, at + 13 + len(name) + len(body))
        if children or not values:
            body += bytes(13)
        return struct.pack("<IIIB", at + 13 + len(name) + len(body), len(values), len(head), len(name)) + name.encode() + body

    out = b"Kaydara FBX Binary  \0\x1a\0" + struct.pack("<I", 7400)
    for node in tree:
        out += node_bytes(node, len(out))
    return out + bytes(13)


def scenes():
    """FBX, glTF and MVNX of two joints."""
    tree = fbx_tree()
    write("fbx", "limbs.txt.fbx", fbx_text(tree))
    write("fbx", "limbs.fbx", fbx_bytes(tree, False))
    write("fbx", "packed.fbx", fbx_bytes(tree, True))
    times, places = np.float32([0, 1 / 30, 2 / 30]), np.float32([[0, 1, 0], [0, 1, .1], [0, 1, .2]])
    turns = np.float32([[0, 0, 0, 1], [0, .6, 0, .8], [0, 1, 0, 0]])
    bind = np.float32([np.eye(4), np.eye(4)])
    binary = b"".join(array.tobytes() for array in (times, places, turns, bind))
    views, start = [], 0
    for array in (times, places, turns, bind):
        views.append({"buffer": 0, "byteOffset": start, "byteLength": array.nbytes})
        start += array.nbytes
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "Hips", "children": [1]}, {"name": "Leg", "translation": [.1, 0, 0], "scale": [1, 1, 1]}],
        "skins": [{"joints": [0, 1], "inverseBindMatrices": 3}], "buffers": [{"byteLength": len(binary)}],
        "bufferViews": views,
        "accessors": [{"bufferView": i, "componentType": 5126, "count": n, "type": kind} for i, (n, kind) in
                      enumerate(((3, "SCALAR"), (3, "VEC3"), (3, "VEC4"), (2, "MAT4")))],
        "animations": [{"name": "move", "samplers": [{"input": 0, "output": 1}, {"input": 0, "output": 2, "interpolation": "STEP"}],
                        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}},
                                     {"sampler": 1, "target": {"node": 1, "path": "rotation"}}]}],
        "extensions": {"VRMC_vrm": {"humanoid": {"humanBones": {"hips": {"node": 0}}}}}}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    write("gltf", "skin.glb", struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)) +
          struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)
    document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
    write("gltf", "text.gltf", json.dumps(document))
    frame = '<frame type="{}"><orientation>1 0 0 0 1 0 0 0</orientation><position>0 0 1 0 .1 .9</position></frame>'
    write("mvnx", "body.mvnx", '<?xml version="1.0"?><mvnx version="4"><subject frameRate="60"><segments>'
          '<segment label="Pelvis"/><segment label="Leg"/></segments><joints><joint><connector1>Pelvis/j</connector1>'
          "<connector2>Leg/j</connector2></joint></joints><frames>" +
          "".join(frame.format(kind) for kind in ("identity", "tpose", "normal", "normal")) +
          "</frames></subject></mvnx>")


def robot_motions():
    """A few frames in every format that the tool writes, and a sidecar."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for each in ("in", "out"):
            (folder / each).mkdir()
        (folder / "in" / "walk.bvh").write_text(short_bvh("walk.bvh", 4))
        formats = "csv,csv-soma,npz-mjlab,npz-beyondmimic,pkl-gmr,pkl-pbhc"
        run = [str(TOOL), "--method", "gmr", "--frames", "0:3", "--sidecar", "in/walk.bvh", "g1"]
        subprocess.run([*run, "-o", "out/walk", "--format", formats], cwd=folder, check=True, capture_output=True)
        for file in sorted((folder / "out").iterdir()):
            if file.suffix == ".json":
                continue
            write("motion", file.name, file.read_bytes())
            if file.suffix != ".npz":
                write("motion_table", file.name, file.read_bytes())
        sidecar = json.loads((folder / "out" / "walk.csv.json").read_text())
        kept = ("retarget", "output", "options", "inputs")
        write("sidecar", "walk.csv.json", json.dumps({key: sidecar[key] for key in kept}))
        for name, words in (("header", ["--csv-header"]), ("blanks", ["--csv-delimiter", "space"]),
                            ("degrees", ["--csv-header", "--csv-degrees", "--csv-centimetres", "--csv-frame-column",
                                         "--csv-quat", "wxyz"])):
            subprocess.run([*run, *words, "-o", name + ".csv"], cwd=folder, check=True, capture_output=True)
            write("motion", name + ".csv", (folder / (name + ".csv")).read_bytes())
    write("csv", "numbers.csv", "1,2.5,-3e-2\n4,5,6\n")
    write("csv", "header.csv", "# made by hand\ntime,root_x,\"a b\"\r\n0.5,1,2\r\n1,2,3\r\n")
    write("csv", "comment.txt", "# x y z\n1 2 3\n\n4\t5\t6")
    write("csv", "decimal_commas.csv", "\ufeff1,5;2,5\n3;4\n")


def packets_file(packets):
    """Packets preceded by their sizes, as binary-format targets expect."""
    return b"".join(struct.pack(">H", len(each)) + each for each in packets)


def rokoko(frames):
    """Frames of Rokoko Studio as datagrams: whole, in pieces, in an LZ4 frame that stores them, and of version 2."""
    write("stream_rokoko", "wave.bin", packets_file(frames))
    block = struct.pack("<I", len(frames[0]) | 1 << 31) + frames[0]
    stored = bytes.fromhex("04224d18604082") + block + bytes(4)
    write("stream_rokoko", "lz4.bin", packets_file([stored, stored[:900], stored[900:], b""]))
    scene = json.loads(frames[0])["scene"]
    old = {"version": "2,0", "timestamp": 1.5, "actors": [{"name": "a \\\"{", **scene["actors"][0]["body"]}]}
    text = json.dumps(old).encode()
    write("stream_rokoko", "pieces.bin", packets_file([text[:700], text[700:] + b"\n" + text, b"noise {", b"}"]))


def mvn_packets():
    """Xsens MVN's messages: the T-pose, poses whole and in two parts, a prop, meta data."""
    names = ("Pelvis L5 L3 T12 T8 Neck Head RightShoulder RightUpperArm RightForeArm RightHand LeftShoulder LeftUpperArm "
             "LeftForeArm LeftHand RightUpperLeg RightLowerLeg RightFoot RightToe LeftUpperLeg LeftLowerLeg LeftFoot "
             "LeftToe").split()

    def message(kind, sample, part, items, payload):
        return struct.pack(">6sIBBIBBBBHH", b"MXTP" + kind, sample, part, items, 10 * sample, 0, 23, 1, 0, 0,
                           len(payload)) + payload

    def poses(first, last):
        return b"".join(struct.pack(">i3f4f", i, 0.1 * i, 0, 1, 1, 0, 0, 0) for i in range(first, last))

    scale = struct.pack(">i", 23) + b"".join(
        struct.pack(">i", len(name)) + name.encode() + struct.pack(">3f", 0, 0.1 * i, 1) for i, name in enumerate(names))
    return [message(b"13", 0, 0x80, 1, scale + struct.pack(">i", 0)), message(b"12", 0, 0x80, 1, b"name:Anna\n"),
            message(b"02", 1, 0x80, 24, poses(1, 24) + poses(25, 26)), message(b"02", 2, 0x81, 12, poses(12, 24)),
            message(b"02", 2, 0, 11, poses(1, 12)), message(b"24", 3, 0x80, 1, bytes(12))]


def natnet_packets(version):
    """NatNet's messages with each section that there is: a server, descriptions, a frame."""
    sized = version >= (4, 1)

    def message(kind, payload):
        return struct.pack("<HH", kind, len(payload)) + payload

    def bone(name, number, parent):
        rotation = struct.pack("<4f", 0, 0, 0, 1) if version >= (4, 2) else b""
        markers = struct.pack("<i3fi", 1, 0, 0.1, 0, 5) + (b"Waist\0" if version >= (4, 0) else b"")
        return name + b"\0" + struct.pack("<ii3f", number, parent, 0, 0.4, 0) + rotation + markers

    def described(kind, item):
        return struct.pack("<i", kind) + (struct.pack("<i", len(item)) if sized else b"") + item

    def section(count, items):
        return struct.pack("<i", count) + (struct.pack("<i", len(items)) if sized else b"") + items

    def body(number, y):
        return struct.pack("<i3f4ffh", number, 0.1, y, 0, 0, 0, 0, 1, 0.001, 1)

    bones = bone(b"Anna_Hip", 1, 0) + bone(b"Anna_Ab", 2, 1) + bone(b"Anna_LThigh", 3, 1)
    sets = [described(0, b"all\0" + struct.pack("<i", 1) + b"Waist\0"), described(1, bone(b"Box", 4, -1)),
            described(2, b"Anna\0" + struct.pack("<ii", 2, 3) + bones),
            described(3, struct.pack("<i", 1) + b"FP\0" + bytes(163 * 4) + struct.pack("<i", 1) + b"Fx\0"),
            described(4, struct.pack("<i", 1) + b"DAQ\0" + b"1\0" + bytes(8) + struct.pack("<i", 1) + b"ai0\0"),
            described(5, b"Prime\0" + bytes(28))]
    channels = struct.pack("<iiif", 1, 1, 1, 0.5)
    skeleton = struct.pack("<ii", 2, 3) + body(2 << 16 | 1, 0.9) + body(2 << 16 | 2, 1.3) + body(2 << 16 | 3, 1.3)
    frame = struct.pack("<i", 8) + section(1, b"all\0" + struct.pack("<i3f", 1, 0, 1, 0)) + section(1, bytes(12))
    frame += section(1, body(4, 0)) + section(1, skeleton)
    frame += section(1, struct.pack("<iii", 1, 0, 0)) if sized else b""
    frame += section(1, struct.pack("<i4fhf", 1, 0, 1, 0, 0.01, 0, 0)) + section(1, channels) + section(1, channels)
    frame += struct.pack("<iid3Q", 0, 0, 2.5, 1, 2, 3) + (bytes(8) if sized else b"") + struct.pack("<hi", 0, 0)
    server = b"Motive".ljust(256, b"\0") + bytes((3, 1, 0, 0, *version, 0, 0))
    return [message(1, server), message(5, struct.pack("<i", len(sets)) + b"".join(sets)), message(7, frame)]


def streams():
    """Packets of streams, as the tool's own player sends them, and a recording."""
    with tempfile.TemporaryDirectory() as folder:
        clip = pathlib.Path(folder) / "short.bvh"
        clip.write_text(short_bvh("wave.bvh", 2))
        for form in ("lines", "bvh", "smplx", "xrobot", "rokoko"):
            played = subprocess.run([TOOL, "live", "-q", "--play", clip, "--speed", "0", "--to",
                                     f"stdout?format={form}"], check=True, capture_output=True)
            if form == "rokoko":
                rokoko(played.stdout.splitlines())
            else:
                write(f"stream_{form}", "wave.txt", played.stdout)
    zeros = json.dumps([0] * 66)
    write("stream_smplx", "odd.txt", '{"up": "y", "height": 1.6}\nrestart\n'
          f'{{"time": 1, "betas": [1, 0.5], "trans": [0, 0, 1], "poses": {zeros}, "left_hand_pose": [0.1]}}\n'
          '{"transl": [0, 0, 1], "root_orient": [[1.5, 0, 0]], "pose_body": [[1]]}\n')
    places = ((0, 9, 0), (-1, 9, 0), (1, 9, 0), (0, 10, 0), (-1, 5, 0), (1, 5, 0), (0, 11, 0), (-1, 1, 0), (1, 1, 0),
              (0, 12, 0), (-1, 0, -1), (1, 0, -1), (0, 14, 0), (-1, 14, 0), (1, 14, 0), (0, 16, 0), (-2, 14, 0),
              (2, 14, 0), (-4, 14, 0), (4, 14, 0), (-7, 14, 0), (7, 14, 0), (-8, 14, 0), (8, 14, 0))
    tracked = {"timeStampNs": 5, "Body": {"joints": [{"p": ",".join(str(x / 10) for x in place) + ",0,0,0,1"}
                                                     for place in places]}}
    write("stream_xrobot", "odd.txt", "\n".join(json.dumps(line) for line in (
        {"joints": [[0, 0, 0, 0, 0, 0, 1]] * 24}, tracked, {"value": json.dumps(tracked)}, {"value": "{"})) +
        "\nrestart\n" + json.dumps({"time": 1, "joints": [[*place, 0, 0, 0, 0.5] for place in places]}) + "\n")
    pose = "[0.5, 0.9, 0, 1, 0, 0, 0]"
    write("stream_lines", "odd.txt", "noise\n" + '{"skeleton": {"pose": "t-pose", "up": "y", "unit": 0.01, "height": 1.8, '
          f'"joints": [{{"name": "a", "parent": null, "rest": {pose}}}, {{"name": "b", "parent": "a"}}]}}}}\n'
          f'{{"time": 1, "joints": {{"a": {pose}, "b": {pose}}}}}\nrestart\n{{"joints": {{"b": [1]}}}}\n')
    def osc(address, types, *values):
        def text(word):
            return word.encode() + bytes(4 - len(word) % 4)
        packed = b"".join(text(value) if isinstance(value, str) else struct.pack(">f", value) for value in values)
        return text(address) + text("," + types) + packed

    bones = ("Hips", "Spine", "Head", "LeftUpperArm", "LeftHand", "Hips")
    messages = [osc("/VMC/Ext/T", "f", 1.5), osc("/VMC/Ext/Root/Pos", "sfffffff", "root", 0, 0, 0, 0, 0, 0, 1),
                *(osc("/VMC/Ext/Bone/Pos", "sfffffff", bone, 0.1, 0.2, 0.3, 0, 0, 0.6, 0.8) for bone in bones)]
    bundle = b"#bundle\0" + bytes(8) + b"".join(struct.pack(">i", len(each)) + each for each in messages)
    write("stream_vmc", "frames.bin", packets_file([*messages, bundle]))
    write("stream_mvn", "messages.bin", packets_file(mvn_packets()))
    for version in ((3, 0), (4, 0), (4, 1), (4, 2)):
        write("stream_natnet", "natnet_{}_{}.bin".format(*version), packets_file(natnet_packets(version)))
    write("stream_record", "two.stream", "S 5 0\n\nP 7 3\na\nb\nC 9 0\n\nE 10 0\n\n")


if __name__ == "__main__":
    lines_of_bvh()
    streams()
    arrays()
    body_model()
    pickles()
    meshes()
    torch_files()
    scenes()
    robot_motions()
