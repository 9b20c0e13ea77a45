"""Batches and their galleries, for several tests."""

import base64
import json
import re
import zlib

from tool import ToolTest, short_clip

ODD = "a b <img src=x onerror=alert(1)> \"'&\u00e9\u202e.bvh"


def data_of(path, name):
    """The JSON that a page carries."""
    text = re.search(rf'id="{name}">(.*?)</script>', path.read_text(), re.S)[1]
    return json.loads(text if text.startswith("{") else zlib.decompress(base64.b64decode(text)))


class GalleryTest(ToolTest):
    """Support for both kinds of tests."""

    def batch(self, *options, clips=("walk", "squat")):
        for name in clips:
            self.write(f"clips/{name}.bvh", short_clip(name, 40))
        self.run_tool("batch", "clips", "-o", "out", "--robot", "unitree_g1", "--method", "gmr",
                      *options)

    def gallery(self, *options, folder="out"):
        return self.run_tool("view", folder, "-o", "gallery", *options)

    def index(self):
        return data_of(self.folder / "gallery/index.html", "gallery")

    def entries(self):
        lines = (self.folder / "out/manifest.jsonl").read_text().splitlines()
        return [json.loads(line) for line in lines]

    def write_entries(self, entries, name="manifest.jsonl"):
        self.write(f"out/{name}", "".join(json.dumps(entry) + "\n" for entry in entries))
