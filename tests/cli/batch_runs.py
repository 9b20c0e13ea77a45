"""Support for tests of retarget batch: runs, and the contents of the output folder."""

import csv
import json

from tool import ToolTest, sample, short_clip

FAST = ("--method", "gmr", "--no-quality")


class BatchTest(ToolTest):
    def batch(self, *arguments, inputs=("in",), output="out", robot="unitree_g1", fast=True,
              **options):
        return self.run_tool("batch", *inputs, "-o", output, *(["--robot", robot] if robot else []),
                             *(FAST if fast else ()), *arguments, **options)

    def clips(self, *names, folder="in", frames=2):
        for name in names:
            self.write(f"{folder}/{name}", short_clip("wave", frames))

    def long_clip(self, name="long.bvh", folder="in"):
        """Writes a clip that takes seconds, so that a batch still runs when a signal arrives. It starts first."""
        lines = sample("walk").read_text().splitlines(keepends=True)
        motion = next(i for i, line in enumerate(lines) if line.startswith("Frames:"))
        rows = lines[motion + 2:] * 100
        self.write(f"{folder}/{name}", "".join([*lines[:motion], f"Frames: {len(rows)}\n", lines[motion + 1], *rows]))

    def lines(self, name, folder="out"):
        return (self.folder / folder / name).read_text().splitlines()

    def manifest(self, path="out/manifest.jsonl"):
        return [json.loads(line) for line in (self.folder / path).read_text().splitlines()]

    def summary(self, path="out/summary.csv"):
        with open(self.folder / path, newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def outputs(self, folder="out", end=".csv"):
        root = self.folder / folder
        return sorted(str(f.relative_to(root)) for f in root.rglob("*" + end)
                      if f.name != "summary.csv")

    def contents(self, folder="out"):
        return {name: (self.folder / folder / name).read_bytes() for name in self.outputs(folder)}
