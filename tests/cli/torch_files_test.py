"""Motions of SMPL in files of PyTorch, pickles and single arrays: the result equals that of the NPZ file."""

import gzip
import json
import os
import pickle
import unittest

from tool import SHARED, ToolTest, difference, needs_shared, read_rows, sample

try:
    import numpy
    from torch_writer import TorchPickle, archive_of, named, sequence, torch_bytes
except ImportError:
    numpy = None

FRAMES = 60


def turned(vectors, axis, angle):
    """Rotation vectors (F, 3), each after a turn of the world about one of its axes."""
    half = numpy.linalg.norm(vectors, axis=1)[:, None] / 2
    unit = vectors / numpy.maximum(2 * half, 1e-300)
    w, v = numpy.cos(half), unit * numpy.sin(half)
    turn = numpy.zeros(3)
    turn[axis] = numpy.sin(angle / 2)
    cosine = numpy.cos(angle / 2)
    w, v = cosine * w - v @ turn[:, None], cosine * v + w * turn + numpy.cross(turn, v)
    size = numpy.linalg.norm(v, axis=1)[:, None]
    return v / size * 2 * numpy.arctan2(size, w)


def walking():
    """Returns a body walking in place, Z up, as AMASS arrays (F rows, radians, m)."""
    phase = numpy.arange(FRAMES) / 30 * 2 * numpy.pi
    body = numpy.zeros((FRAMES, 63))
    swing = 0.5 * numpy.sin(phase)
    for joint, angle in ((1, swing), (2, -swing), (4, 0.6 * numpy.maximum(-swing, 0)),
                         (5, 0.6 * numpy.maximum(swing, 0))):
        body[:, 3 * (joint - 1)] = angle
    body[:, 3 * 15 + 2], body[:, 3 * 16 + 2] = -1.2, 1.2  # arms down
    upright = numpy.zeros((FRAMES, 3))
    upright[:, 0] = numpy.pi / 2
    trans = numpy.zeros((FRAMES, 3))
    trans[:, 2] = 0.9
    return {"root_orient": turned(upright, 2, 0.3), "pose_body": body, "trans": trans,
            "betas": numpy.zeros(10), "gender": "neutral", "fps": 30}


@unittest.skipIf(numpy is None, "needs numpy")
class TorchFiles(ToolTest):
    def csv_of(self, name, content, *options):
        """Retargets a file to the G1; returns the rows and the result."""
        self.write(name, content)
        result = self.run_tool(name, "g1", "-o", "out.csv", *options)
        self.assert_done(result)
        return read_rows((self.folder / "out.csv").read_text()), result

    def npz_rows(self, motion):
        numpy.savez(self.folder / "expected.npz", **motion)
        return self.csv_of("expected.npz", (self.folder / "expected.npz").read_bytes())[0]

    def assert_same(self, rows, expected, tolerance=0.0):
        self.assertIsNone(difference(rows, expected, tolerance))

    def test_results_of_gvhmr(self):
        motion = walking()
        # The world has y up: rotated by a right angle relative to the clip; the file has floats.
        world = {"body_pose": motion["pose_body"].astype("f4"),
                 "global_orient": turned(motion["root_orient"], 0, -numpy.pi / 2).astype("f4"),
                 "transl": numpy.asfortranarray(motion["trans"][:, [0, 2, 1]].astype("f4")),
                 "betas": numpy.broadcast_to(numpy.zeros(10, "f4"), (FRAMES, 10))}
        content = torch_bytes({"smpl_params_global": world, "smpl_params_incam": dict(world),
                               "K_fullimg": numpy.zeros((FRAMES, 3, 3), "f4"), "net_outputs": {}})
        rows, result = self.csv_of("hmr4d_results.pt", content)
        self.assertIn("assuming GVHMR's 30 fps", result.stderr)
        self.assertIn("up +z", result.stderr)
        first = (self.folder / "out.csv").read_bytes()
        self.assert_same(rows, self.npz_rows(motion), 2e-5)
        # The same by its option, by standard input, and at another rate.
        result = self.run_tool("--smpl", "hmr4d_results.pt", "--robot", "g1", "-o", "again.csv")
        self.assert_done(result)
        self.assertEqual((self.folder / "again.csv").read_bytes(), first)
        result = self.run_tool("inspect", "hmr4d_results.pt", "--source-fps", "25", "--json")
        self.assert_done(result)
        self.assertNotIn("30 fps", result.stderr)
        self.assertIn("up", json.dumps(json.loads(result.stdout)))

    def test_dictionaries_equal_the_npz(self):
        motion = walking()
        expected = self.npz_rows(motion)
        store = numpy.concatenate([numpy.full((FRAMES, 7), 9.0), motion["trans"]], axis=1)
        viewed = {**motion, "trans": store[:, 7:]}  # A view with an offset and strides.
        for name, content in (
                ("views.pt", torch_bytes(viewed)), ("packed.pt", torch_bytes(motion, True)),
                ("nested.pt", torch_bytes({"person": motion})),
                ("motion.pkl", pickle.dumps(motion)),
                ("motion.pkl.gz", gzip.compress(pickle.dumps(motion))), ("old.p", pickle.dumps([motion], 2)),
                ("names.npz", None)):
            with self.subTest(name):
                if content is None:
                    numpy.savez(self.folder / name, global_orient=motion["root_orient"],
                                body_pose=motion["pose_body"], transl=motion["trans"],
                                betas=motion["betas"], gender="neutral", fps=30)
                    content = (self.folder / name).read_bytes()
                self.assert_same(self.csv_of(name, content)[0], expected)

    def test_batch_finds_them(self):
        motion = walking()
        self.write("clips/a.pt", torch_bytes(motion))
        numpy.save(self.folder / "clips" / "b.npy",
                   numpy.concatenate([motion["trans"][:, [0, 2, 1]],
                                      turned(motion["root_orient"], 0, -numpy.pi / 2),
                                      motion["pose_body"]], axis=1))
        self.write("clips/weights.pkl", b"nothing to do with it")
        result = self.run_tool("batch", "clips", "-o", "out", "--robot", "g1")
        self.assert_done(result)
        self.assertIn("out/a.csv", self.files())
        self.assertIn("out/b.csv", self.files())
        self.assertNotIn("weights", " ".join(self.files()).replace("clips/weights", ""))

    def test_centimetres_are_found(self):
        motion = walking()
        expected = self.npz_rows(motion)
        numpy.savez(self.folder / "cm.npz", **{**motion, "trans": 100 * motion["trans"]})
        rows, result = self.csv_of("cm.npz", (self.folder / "cm.npz").read_bytes())
        self.assertIn("assuming that trans is in centimetres", result.stderr)
        self.assert_same(rows, expected, 2e-6)

    def test_other_files_are_reported(self):
        motion = walking()
        numbers = numpy.arange(6, dtype="f4")
        big = named("torch._utils", "_rebuild_tensor_v2")
        made = TorchPickle()
        storage = sequence(made.value("storage"), named("torch", "FloatStorage"), made.value("0"),
                           made.value("cpu"), made.value(6)) + b"Q"

        def view(offset, shape, strides):
            layout = (sequence(*map(made.value, shape)), sequence(*map(made.value, strides)))
            opcodes = big + sequence(storage, made.value(offset), *layout, b"\x89", b"}") + b"R"
            return archive_of(b"\x80\x02" + made.value({**motion, "poses": opcodes}) + b".",
                              [numbers.tobytes()])

        motion_without = {key: motion[key] for key in ("trans", "betas", "gender", "fps")}
        motion = motion_without
        evil = named("os", "system") + sequence(made.value("touch executed")) + b"R"
        nan = walking()
        nan["trans"][3, 1] = numpy.nan
        whole = torch_bytes(walking())
        cases = (
            ("evil.pt", torch_bytes({"poses": evil}), "the pickle names os.system"),
            ("evil.pkl", b"\x80\x02" + evil + b".", "the pickle names os.system"),
            ("short.pt", whole[:len(whole) // 2], "the file was cut off"),
            ("nan.pt", torch_bytes(nan), 'array "trans": NaN in frame 3, column 1'),
            ("text.pt", torch_bytes({**motion, "poses": "walk"}), "found text of"),
            ("beyond.pt", view(4, (1, 66), (1, 1)), "exceeds its storage of 6 numbers"),
            ("huge.pt", view(0, (1 << 40, 66), (0, 0)), "but its storage has 24 bytes"),
            ("overflow.pt", view(0, (3, 66), (1 << 62, 1)), "exceeds its storage"),
            ("strides.pt", view(0, (1, 66), (1,)), "do not match its shape"),
            ("weights.pt", torch_bytes({"conv.weight": numbers}), "a dictionary of conv.weight"),
            ("tensor.pt", torch_bytes(numbers), "one tensor of shape (6,)"),
            ("robot.pt", torch_bytes({"dof_pos": numbers}), "found a robot motion"),
            ("robot.pkl", pickle.dumps({"root_pos": 1, "dof_pos": 2}), "found a robot motion"),
            ("legacy.pt", b"\x80\x02\x8a\x0al\xfc\x9cF\xf9 j\xa8P\x19.\x80\x02M\xe9\x03.",
             "torch.save(torch.load("),
            ("two.p", pickle.dumps({0: walking(), 1: walking()}), "the file holds 2 motions: 0, 1"),
            ("objects.pkl", pickle.dumps({**walking(), "pose_body": walking()["pose_body"].astype(
                object)}), "expected an array of numbers, found one of Python objects"),
            ("walk.bvh.gz", gzip.compress(b"HIERARCHY"), "does not contain a pickle"),
            ("camera.pt", torch_bytes({"smpl_params_incam": {"betas": numbers}}), "camera axes"),
            ("bomb.pt", torch_bytes({"poses": numpy.zeros((100000, 66), "f4"), **motion}, True),
             "but its storage has"),
            ("wide.pt", torch_bytes(numpy.zeros((3, 591), "f4")), "not a unit quaternion"),
        )
        for name, content, words in cases:
            with self.subTest(name):
                self.write(name, content)
                result = self.run_tool(name, "g1", "-o", "o.csv")
                self.assert_fails(result, 3, name, words, *(("hint:",) if "nan" not in name and
                                                            name not in ("text.pt", "beyond.pt",
                                                                         "overflow.pt", "wide.pt",
                                                                         "strides.pt") else ()))
        self.assertFalse((self.folder / "executed").exists())
        self.assertNotIn("o.csv", self.files())
        positions = numpy.zeros((4, 22, 3))
        numpy.save(self.folder / "joints.npy", positions)
        self.assert_fails(self.run_tool("joints.npy", "g1", "-o", "o.csv"), 3,
                          "in the joint order of SMPL", "--joint-names")

    def test_the_content_determines_the_format(self):
        self.write("really.bvh", torch_bytes(walking()))
        self.assert_done(self.run_tool("really.bvh", "g1", "-o", "o.csv"))
        self.write("really.pt", sample("wave").read_bytes())
        self.assert_done(self.run_tool("really.pt", "g1", "-o", "o.csv"))


@needs_shared
class RealFiles(ToolTest):
    def test_keep_the_gates(self):
        folder = SHARED / "data" / "formats"
        for name in ("gvhmr_hmr4d_results.pt", "omomo_sub3_largebox_003.pt"):
            with self.subTest(name):
                result = self.run_tool(folder / name, "g1", "-o", "o.csv", "--report", "o.json")
                self.assert_done(result)
                missed = {gate["metric"] for gate in json.loads(
                    (self.folder / "o.json").read_text())["motions"][0]["gates"]
                    if not gate["passed"]}
                if name.startswith("gvhmr"):
                    # Its body is thrown about for two frames and stays in the air for two seconds,
                    # and its feet do not rest.
                    always = {"com_acc_p99", "hover_pct", "missing_surface_pct",
                              "source_slide_mean"}
                    self.assertLessEqual(always, missed)
                    self.assertLessEqual(missed, always | {"root_acc_p99", "root_jerk_mean"})
                else:
                    self.assertEqual(missed, set())

    def test_a_robots_motion_is_reported(self):
        file = SHARED / "data" / "formats" / "protomotions_g1_walk.motion"
        self.assert_fails(self.run_tool(file, "g1", "-o", "o.csv"), 3, "found a robot motion",
                          "dof_pos", "--from-robot NAME", "retarget convert")


if __name__ == "__main__":
    unittest.main()
