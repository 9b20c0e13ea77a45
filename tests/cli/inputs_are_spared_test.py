"""No output of any command overwrites an input of the command, under any name."""

import json
import os
import subprocess
import unittest

from tool import SOURCE, TOOL, ToolTest, needs_posix, sample, short_clip, unwrapped

G1 = SOURCE / "robots/unitree_g1"


class Spared(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("a.bvh", sample("wave").read_bytes())
        self.write("b.bvh", sample("walk").read_bytes())
        (self.folder / "sub").mkdir()
        os.symlink("a.bvh", self.folder / "soft.bvh")
        os.link(self.folder / "a.bvh", self.folder / "hard.bvh")

    def assert_spared(self, *arguments, **options):
        before = {name: (self.folder / name).read_bytes() for name in self.files()}
        result = self.run_tool(*arguments, **options)
        self.assert_fails(result, 2, "overwrite the input")
        self.assertEqual({name: (self.folder / name).read_bytes() for name in self.files()}, before,
                         arguments)

    def test_inspect(self):
        for option in ("--write-map", "--positions"):
            for name in ("a.bvh", "soft.bvh", "hard.bvh", "sub/../a.bvh", self.folder / "a.bvh"):
                self.assert_spared("inspect", "a.bvh", option, name)
        self.assert_done(self.run_tool("inspect", "a.bvh", "--write-map", "map.json"))
        self.assert_spared("inspect", "a.bvh", "--map", "map.json", "--positions", "map.json")
        both = self.run_tool("inspect", "a.bvh", "--write-map", "x", "--positions", "sub/../x")
        self.assert_fails(both, 2, "two outputs")

    def test_edit(self):
        self.assert_done(self.run_tool("edit", "path", "b.bvh", "--fit", "path.json"))
        self.assert_done(self.run_tool("inspect", "a.bvh", "--write-map", "map.json"))
        for arguments in (("path", "a.bvh", "--svg", "a.bvh"), ("path", "a.bvh", "--fit", "hard.bvh"),
                          ("path", "b.bvh", "--to", "path.json", "--svg", "path.json"),
                          ("path", "b.bvh", "--to", "path.json", "-o", "path.json"),
                          ("path", "a.bvh", "--to", "circle", "-o", "soft.bvh"),
                          ("path", "a.bvh", "--map", "map.json", "--fit", "map.json"),
                          ("concat", "a.bvh", "b.bvh", "-o", "c.bvh", "--matrix", "a.bvh"),
                          ("concat", "a.bvh", "b.bvh", "-o", "b.bvh"),
                          ("transfer", "a.bvh", "--to", "b.bvh", "-o", "b.bvh"),
                          ("transfer", "a.bvh", "--to", "b.bvh", "-o", "soft.bvh"),
                          ("rest", "a.bvh", "--like", "b.bvh", "-o", "b.bvh"),
                          ("mirror", "a.bvh", "-o", "hard.bvh"),
                          ("mirror", "a.bvh", "-o", "x.bvh", "--write-map", "a.bvh"),
                          ("trim", "a.bvh", "--end", "1", "-o", "a.bvh")):
            self.assert_spared("edit", *arguments)

    def test_run(self):
        for arguments in (("-o", "soft.bvh"), ("-o", "x.csv", "--report", "hard.bvh"),
                          ("-o", "x.csv", "--png", "soft.bvh"), ("-o", "x.csv", "--write-map", "sub/../a.bvh")):
            self.assert_spared("a.bvh", "g1", *arguments)
        for file in G1.iterdir():
            if file.is_file():
                self.write(f"mine/{file.name}", file.read_bytes())
        for name in ("model.xml", "robot.json", "ik.json"):
            if (self.folder / "mine" / name).exists():
                self.assert_spared("a.bvh", "mine", "-o", "x.csv", "--report", f"mine/{name}")

    def test_standard_streams(self):
        with open(self.folder / "a.bvh", "rb") as stream:
            self.assert_spared("-", "g1", "-o", "x.csv", "--report", "a.bvh", stdin=stream)

    def test_convert_and_evaluate(self):
        self.assert_done(self.run_tool("a.bvh", "g1", "-o", "x.csv", "--method", "gmr"))
        os.symlink("x.csv", self.folder / "y.csv")
        self.assert_spared("convert", "x.csv", "y.csv", "--robot", "g1")
        self.write("gates.json", (SOURCE / "configs/quality/default.json").read_bytes())
        for name in ("x.csv", "y.csv", "soft.bvh", "gates.json"):
            self.assert_spared("evaluate", "x.csv", "--robot", "g1", "--bvh", "a.bvh", "--gate",
                               "gates.json", "--json", name)
        self.assert_spared("evaluate", "x.csv", "--robot", "g1", "--bvh", "a.bvh", "--write-map",
                           "x.csv")

    def test_live(self):
        self.assert_done(self.run_tool("inspect", "a.bvh", "--write-map", "map.json"))
        self.write("fit.json", '{"max_joint_speed": 5}')
        source = ("live", "--robot", "g1", "--input", "udp:0?format=bvh", "--seconds", "0.1")
        from_a = (*source, "--skeleton", "a.bvh")
        for arguments in ((*from_a, "-o", "a.bvh"), (*from_a, "-o", "soft.bvh"),
                          (*from_a, "-o", "sub/../a.bvh?format=jsonl"),
                          (*from_a, "-o", "x.csv", "--stats", "hard.bvh"),
                          (*source, "--fit-config", "fit.json", "-o", "fit.json"),
                          (*source, "--map", "map.json", "-o", "x.csv,map.json")):
            self.assert_spared(*arguments)
        for file in G1.iterdir():
            if file.is_file():
                self.write(f"mine/{file.name}", file.read_bytes())
        self.assert_spared("live", "--robot", "mine", "--input", "udp:0?format=bvh", "-o",
                           "mine/model.xml")
        with open(self.folder / "a.bvh", "rb") as stream:
            self.assert_spared("live", "--robot", "g1", "--input", "stdin?format=bvh", "-o",
                               "a.bvh", stdin=stream)

    @needs_posix
    def test_live_without_an_output_option_writes_to_the_standard_output(self):
        with open(self.folder / "a.bvh", "rb") as stream, open(self.folder / "a.bvh", "ab") as out:
            done = subprocess.run(
                [TOOL, "live", "--robot", "g1", "--input", "stdin?format=bvh"], cwd=self.folder,
                stdin=stream, stdout=out, stderr=subprocess.PIPE, text=True, timeout=60,
                env=self.tool_environment(), check=False)
        done.stderr = unwrapped(done.stderr)
        self.assert_fails(done, 2, "overwrite the input")
        self.assertEqual((self.folder / "a.bvh").read_bytes(), sample("wave").read_bytes())

    def test_recordings(self):
        live = ("live", "--robot", "g1", "--input", "stdin?format=bvh")
        with open(self.folder / "a.bvh", "rb") as stream:
            self.assert_done(self.run_tool(*live, "--record", "take", "-o", "x.csv", stdin=stream))
        for name in ("input.stream", "live.json"):
            self.assert_spared("live", "--replay", "take", "-o", f"take/{name}")
        self.assert_done(self.run_tool("live", "--replay", "take", "-o", "again.csv"))
        self.assertEqual((self.folder / "again.csv").read_bytes(),
                         (self.folder / "x.csv").read_bytes())

    def test_live_does_not_send_to_its_own_input(self):
        for address, output in (("udp:47219", "udp:47219"), ("udp:0.0.0.0:47219", "udp:47219"),
                                ("udp:47219", "udp:0.0.0.0:47219")):
            result = self.run_tool("live", "--robot", "g1", "--input", f"{address}?format=bvh", "-o",
                                   output, "--seconds", "0.1")
            self.assert_fails(result, 2, "also the input")

    def test_outputs_of_live_runs_are_distinct(self):
        (self.folder / "take").mkdir()
        source = ("live", "--robot", "g1", "--input", "udp:0?format=bvh", "--seconds", "0.1")
        before = self.files()
        for outputs in (("-o", "x.csv", "-o", "./x.csv"), ("-o", "x.csv,x.csv?format=jsonl"),
                        ("-o", "x.jsonl", "--stats", "sub/../x.jsonl"),
                        ("--record", "take", "-o", "take/output.jsonl"),
                        ("--record", "take", "-o", "x.csv", "--stats", "take/input.stream")):
            self.assert_fails(self.run_tool(*source, *outputs), 2, "two outputs name the same file")
        self.assertEqual(self.files(), before)

    def test_batch(self):
        self.write("in/walk.bvh", short_clip("wave", 2))
        (self.folder / "out").mkdir()
        for name in ("walk.csv", "manifest.jsonl", "summary.csv", "options.json", "walk.csv.json"):
            os.symlink("../in/walk.bvh", self.folder / "out" / name)
            self.assert_spared("batch", "in", "-o", "out", "--robot", "g1", "--method", "gmr",
                               "--redo", "--sidecar")
            (self.folder / "out" / name).unlink()


if __name__ == "__main__":
    unittest.main()
