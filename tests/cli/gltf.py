"""Reads GLB files, and asks Khronos's validator about them; independent of the writer."""

import json
import os
import pathlib
import shutil
import struct
import subprocess

import numpy as np

SOURCE = pathlib.Path(__file__).resolve().parents[2]
COMPONENTS = {5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}

VALIDATE = """
const { validateBytes } = require('gltf-validator');
const fs = require('fs');
validateBytes(new Uint8Array(fs.readFileSync(process.argv[1])))
  .then((report) => console.log(JSON.stringify(report.issues)));
"""


def validator_folder():
    """The folder of npm's modules, or the reason why it is missing as text."""
    if not shutil.which("node"):
        return None, "there is no node (Debian: nodejs)"
    folder = SOURCE / "build/deps/node/node_modules"
    if not (folder / "gltf-validator").is_dir():
        return None, f"no gltf-validator in {folder}: tools/setup.sh fetches it where there is npm"
    return folder, ""


def issues(path, folder):
    """The validator's report on a file: messages with a severity (0 error, 1 warning)."""
    result = subprocess.run(["node", "-e", VALIDATE, str(path)], text=True, check=True, timeout=60,
                            stdout=subprocess.PIPE, env={**os.environ, "NODE_PATH": str(folder)})
    return json.loads(result.stdout)["messages"]


def matrix(quaternion_xyzw):
    """Rotation matrices (..., 3, 3) of unit quaternions (..., 4)."""
    x, y, z, w = np.moveaxis(np.asarray(quaternion_xyzw, float), -1, 0)
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


class Glb:
    """A GLB file: its JSON, its numbers, and its node poses over the animation."""

    def __init__(self, path):
        data = pathlib.Path(path).read_bytes()
        magic, version, size = struct.unpack_from("<4sII", data)
        assert magic == b"glTF" and version == 2 and size == len(data)
        length, kind = struct.unpack_from("<I4s", data, 12)
        assert kind == b"JSON"
        self.json = json.loads(data[20:20 + length])
        binary_size, kind = struct.unpack_from("<I4s", data, 20 + length)
        assert kind == b"BIN\0" and 28 + length + binary_size == size
        self.binary = data[28 + length:]
        self.nodes = self.json["nodes"]
        self.parents = {child: parent for parent, node in enumerate(self.nodes)
                        for child in node.get("children", [])}

    def accessor(self, index):
        """The numbers of an accessor, (count, components)."""
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        width = WIDTHS[accessor["type"]]
        numbers = np.frombuffer(self.binary, COMPONENTS[accessor["componentType"]],
                                accessor["count"] * width, view["byteOffset"])
        return numbers.reshape(-1, width)

    def node(self, name):
        return next(i for i, node in enumerate(self.nodes) if node.get("name") == name)

    def times(self):
        """Returns the key times of the first sampler, seconds."""
        return self.accessor(self.json["animations"][0]["samplers"][0]["input"])[:, 0]

    def local(self, frames):
        """Rotation (frames, 3, 3) and translation (frames, 3) of every node in its parent."""
        places = []
        for node in self.nodes:
            rotation = np.tile(node.get("rotation", [0, 0, 0, 1]), (frames, 1))
            translation = np.tile(node.get("translation", [0, 0, 0]), (frames, 1))
            places.append({"rotation": rotation, "translation": translation})
        animation = self.json["animations"][0]
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            assert sampler["interpolation"] == "LINEAR"
            keys = self.accessor(sampler["output"])
            target = channel["target"]
            places[target["node"]][target["path"]] = keys[:frames]
        return [(matrix(place["rotation"]), place["translation"].astype(float)) for place in places]

    def world(self, frames):
        """The same of every node in the world, Y up."""
        local, done = self.local(frames), {}

        def place(index):
            if index not in done:
                rotation, translation = local[index]
                if index in self.parents:
                    above, origin = place(self.parents[index])
                    translation = origin + np.einsum("fij,fj->fi", above, translation)
                    rotation = above @ rotation
                done[index] = rotation, translation
            return done[index]

        return [place(index) for index in range(len(self.nodes))]


def z_up(points):
    """Converts points (..., 3) from glTF's world, Y up, to Z up."""
    points = np.asarray(points)
    return np.stack([points[..., 0], -points[..., 2], points[..., 1]], axis=-1)
