"""No file below 100 kB needs more than 300 MB, ends by a signal or hangs."""

import io
import os
import pickle
import struct
import subprocess
import unittest
import zipfile
import zlib

from tool import ToolTest, is_sanitized, sample

try:
    import numpy
    from torch_writer import TorchPickle, archive_of, named, sequence, torch_bytes
except ImportError:
    numpy = None

FRAME_TIME = "MOTION\nFrames: {}\nFrame Time: {}\n"
BALL = '<body name="b"><freejoint/><geom size="0.1"/></body>'


def bvh(joints, frames, row="0", rate=0.0333):
    """Joints below a root of one channel."""
    return ("HIERARCHY\nROOT a{OFFSET 0 1 0 CHANNELS 1 Xrotation\n" + joints + "}\n" +
            FRAME_TIME.format(frames, rate) + f"{row}\n" * frames)


def npy(shape, kind="|u1", data=None):
    header = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}"
    header += " " * (63 - (10 + len(header)) % 64) + "\n"
    size = int(kind[2:])
    for part in shape:
        size *= part
    return (b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode() +
            (bytes(size) if data is None else data))


def npz(**arrays):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in arrays.items():
            archive.writestr(name + ".npy", content)
    return packed.getvalue()


def rate(fps):
    return npy((1,), "<f8", struct.pack("<d", fps))


def tracking(frames):
    return npz(fps=rate(50.0), joint_pos=npy((frames, 29)), joint_vel=npy((frames, 29)),
               body_pos_w=npy((frames, 30, 3)), body_quat_w=npy((frames, 30, 4)),
               body_lin_vel_w=npy((frames, 30, 3)), body_ang_vel_w=npy((frames, 30, 3)))


class SmallFiles(ToolTest):
    def try_all(self, files, *commands, seconds=120):
        """Runs every command (FILE is the file) on every file, by name."""
        for name, content in files.items():
            path = self.write(name, content)
            self.assertLess(path.stat().st_size, 100_000, name)
            for command in commands:
                arguments = [path if word == "FILE" else word for word in command]
                with self.subTest(file=name, command=" ".join(map(str, command))):
                    self.assert_small(self.run_measured(*arguments, seconds=seconds))

    def test_bvh(self):
        static = "JOINT j{OFFSET 0 0 0}"
        moved = ("JOINT j{OFFSET 0 1 0 CHANNELS 6 Xposition Yposition Zposition Zrotation "
                 "Yrotation Xrotation}")
        deep = "".join(f"JOINT j{i}{{OFFSET 0 0 0 " for i in range(1500)) + "}" * 1500
        self.try_all({
            "many_static.bvh": bvh(static * 900, 40000),
            "some_static.bvh": bvh(static * 300, 45000),
            "few_static.bvh": bvh(static * 20, 48000),
            "many_channels.bvh": bvh(moved * 700, 3, "0 " * 4201),
            "claimed_channels.bvh": bvh("JOINT j{OFFSET 0 0 0 CHANNELS 2000000000 Xrotation}", 1),
            "deep.bvh": bvh(deep, 20000),
            "end_sites.bvh": bvh("End Site{OFFSET 0 1 0}" * 4000, 1),
            "long_name.bvh": bvh("JOINT " + "n" * 40000 + "{OFFSET 0 0 0}" + static * 2000, 1),
            "claimed_frames.bvh": bvh("", 10).replace("Frames: 10", "Frames: 2147483647"),
            "shortest.bvh": bvh(static, 10, rate="1e-300"),
            "slow.bvh": bvh(static, 10, rate="1e300"),
        }, ("inspect", "FILE"))

    @unittest.skipIf(is_sanitized(), "a sanitizer takes minutes for long motions")
    def test_bvh_of_a_whole_body(self):
        # One number moves a body of 22 joints: the maximum number of frames.
        lines = sample("wave").read_text().splitlines()
        motion = lines.index("MOTION")
        body, first = [], True
        for line in lines[:motion]:
            if "CHANNELS" in line:
                line = "CHANNELS 1 Yrotation" if first else ""
                first = False
            body.append(line.strip())
        run = ("--bvh", "FILE", "--robot", "unitree_g1", "--method", "gmr")
        files = {f"{frames}_{step}.bvh": "\n".join(body) + "\n" +
                 FRAME_TIME.format(frames, step) + "0\n" * frames
                 for frames, step in ((48000, 0.0333), (500, 1), (20000, 0.1), (3, 300))}
        self.try_all(files, (*run, "-o", "o.csv", "--sidecar", "--report", "r.json"),
                     (*run, "-o", "o.npz", "--format", "npz-mjlab"),
                     (*run, "-o", "o.pkl", "--format", "pkl-gmr"),
                     (*run, "-o", "o.npz", "--format", "npz-mjlab", "--fps", "source"))

    @unittest.skipIf(is_sanitized(), "a sanitizer takes minutes for long motions")
    def test_npz_of_humans(self):
        run = ("--smpl", "FILE", "--robot", "unitree_g1", "--method", "gmr", "-o", "o.csv")
        files = {f"{frames}_{fps}.npz": npz(poses=npy((frames, 66)), trans=npy((frames, 3)),
                                            fps=rate(fps))
                 for frames, fps in ((31000, 30.0), (480000, 30.0), (1000, 1.0), (3000, 1.0))}
        files["names.npz"] = npz(**{f"a{i}": npy((1,)) for i in range(500)})
        files["long.npz"] = npz(**{f"a{i}": npy((9000000,)) for i in range(8)})
        files["claimed.npz"] = npz(poses=npy((10**15, 66), data=b""), trans=npy((1, 3)))
        files["gender.npz"] = npz(poses=npy((9, 66)), trans=npy((9, 3)), fps=rate(30.0),
                                  betas=npy((2000000,)), gender=npy((1,), "<U4000000"))
        self.try_all(files, ("inspect", "FILE"), run)
        # Also with a body model.
        motion = self.write("motion.npz", npz(poses=npy((9, 66)), trans=npy((9, 3)),
                                              fps=rate(30.0)))
        bodies = {f"body{points}.npz": npz(v_template=npy((points, 3)), faces_tree=npy((9, 3)),
                                           J_regressor=npy((joints, points)),
                                           shapedirs=npy((points, 3, 10)),
                                           kintree_table=npy((2, joints)))
                  for points, joints in ((100000, 24), (30000, 52), (10475, 55))}
        self.try_all(bodies, ("--smpl", motion, "--smpl-model", "FILE", "--robot", "unitree_g1",
                              "-o", "o.csv"))

    def test_motions_of_robots(self):
        row = ",".join(["0,0,.8,0,0,0,1"] + ["0"] * 29)
        of_robot = ("--robot", "unitree_g1")
        commands = (("evaluate", "FILE", *of_robot), ("compare", "FILE", "FILE"),
                    ("convert", "FILE", "o.npz", *of_robot, "--format", "npz-mjlab"))
        self.try_all({
            "one_column.csv": "0\n" * 49000,
            "one_row.csv": "0," * 48000 + "0\n",
            "header.csv": "a," * 45000 + "\n",
            "quotes.csv": '"' * 99000,
            "blanks.csv": ",\n" * 45000,
            "rows.csv": (row + "\n") * 1300,
            "times.csv": "".join(f"{i * 1000},{row}\n" for i in range(1100)),
            "10000.npz": tracking(10000), "70000.npz": tracking(70000),
            "200000.npz": tracking(200000),
        }, *commands)

    @unittest.skipIf(numpy is None, "needs numpy")
    def test_pickles(self):
        def motion(frames, fps):
            return zlib.compress(pickle.dumps({
                "fps": fps, "root_pos": numpy.zeros((frames, 3), "u1"),
                "root_rot": numpy.tile([0, 0, 0, 1], (frames, 1)).astype("u1"),
                "dof_pos": numpy.zeros((frames, 29), "u1")}, protocol=4), 9)

        def opcodes(code, count):
            return zlib.compress(b"\x80\x04" + code * count + b".", 9)

        of_robot = ("--robot", "unitree_g1")
        self.try_all({"30000.pkl": motion(30000, 30.0), "100000.pkl": motion(100000, 30.0),
                      "230000.pkl": motion(230000, 30.0), "102000.pkl": motion(102000, 30.0),
                      "slow.pkl": motion(1000, 0.1), "slower.pkl": motion(300, 1.0)},
                     ("evaluate", "FILE", *of_robot),
                     ("convert", "FILE", "o.npz", *of_robot, "--format", "npz-mjlab"),
                     ("convert", "FILE", "o.pkl", *of_robot, "--format", "pkl-gmr"),
                     ("convert", "FILE", "o.csv", *of_robot, "--fps", "60"))
        self.try_all({"lists.pkl": opcodes(b"]", 9000000), "marks.pkl": opcodes(b"(", 3000000),
                      "memo.pkl": opcodes(b"]\x94", 1900000), "same.pkl": opcodes(b"]2", 3000000),
                      "none.pkl": opcodes(b"N", 9000000), "numbers.pkl": opcodes(b"K\x01", 3000000),
                      "nothing.pkl": opcodes(b"\x00", 9000000)}, ("evaluate", "FILE", *of_robot))

    @unittest.skipIf(numpy is None, "needs numpy")
    def test_files_of_pytorch(self):
        def opcodes(code, count, begin=b"", end=b"."):
            return archive_of(b"\x80\x02" + begin + code * count + end, [bytes(64)], True)

        def layout(*sizes):
            return sequence(*(TorchPickle().value(size) for size in sizes))

        name = TorchPickle().value
        storage = sequence(name("storage"), named("torch", "FloatStorage"), name("0"), name("cpu"),
                           name(16)) + b"Q"
        rebuild = named("torch._utils", "_rebuild_tensor_v2")
        view = sequence(storage, name(0), layout(*[1] * 8), layout(*[1] * 8))
        motion = {"poses": numpy.zeros((1, 66), "f4"), "trans": numpy.zeros((1, 3), "f4"), "fps": 30}
        wide = numpy.broadcast_to(motion["poses"], (10**9, 66))
        self.try_all({"lists.pt": opcodes(b"]", 7000000), "marks.pt": opcodes(b"(", 3000000),
                      "memo.pt": opcodes(b"]q\x01", 1900000), "none.pt": opcodes(b"N", 7000000),
                      "views.pt": opcodes(b"h\x01h\x02R", 1000000,
                                          rebuild + b"q\x01" + view + b"q\x02"),
                      "frames.pt": torch_bytes({**motion, "poses": wide}),
                      "rows.pt": torch_bytes(numpy.zeros((60000, 591), "u1"), True),
                      "zeros.pt": torch_bytes({**motion, "poses": numpy.zeros((60000, 66), "u1")}, True),
                      "array.npy": npy((1300, 69)), "wide.npy": npy((290, 322))},
                     ("inspect", "FILE"), ("FILE", "g1", "-o", "o.csv"))

    def test_json(self):
        files = {"numbers.json": "[" + "0," * 49000 + "0]", "lists.json": "[" + "[]," * 32000 + "0]",
                 "objects.json": "[" + "{}," * 32000 + "0]",
                 "texts.json": "[" + '"",' * 32000 + "0]", "deep.json": '{"a":' * 15000,
                 "keys.json": "{" + ",".join(f'"{i}":0' for i in range(1900)) + "}",
                 "escaped.json": '"' + "\\u0000" * 16000 + '"', "digits.json": "1" + "0" * 90000}
        run = ("--bvh", sample("wave"), "--robot", "unitree_g1", "-o", "o.csv")
        self.try_all(files, *((*run, option, "FILE") for option in
                              ("--ik-config", "--fit-config", "--map")), ("verify", "FILE"))

    def test_models(self):
        def model(first, bodies=BALL):
            return f"<mujoco>{first}<worldbody>{bodies}</worldbody></mujoco>"

        hinge = '<body><joint type="hinge"/><geom size="0.1"/></body>'
        mocaps = '<body mocap="true"/>' * 1900
        grid = '<flexcomp name="f" type="grid" count="10 10 10" spacing=".1 .1 .1" dim="3"/>'
        self.try_all({
            "keys.xml": model('<size nkey="10000"/>', f"<body><freejoint/>{hinge * 900}</body>"),
            "mocaps.xml": model('<size nkey="10000"/>', mocaps + BALL),
            "named_keys.xml": model("<keyframe>" + "<key/>" * 7000 + "</keyframe>", mocaps + BALL),
            "deep.xml": model("", "<body><freejoint/>" + hinge.replace("</body>", "") * 280 +
                              "</body>" * 281),
            "wide.xml": model("", f"<body><freejoint/>{hinge * 990}</body>"),
            "bodies.xml": model("", '<replicate count="1900"><body><geom size="1"/></body>'
                                    "</replicate>" + BALL),
            "memory.xml": model('<size memory="3G"/>'),
            "stack.xml": model('<size nstack="100000000"/>'),
            "contacts.xml": model('<size njmax="1000000" nconmax="1000000"/>'),
            "users.xml": model('<size nuser_body="100" nuser_geom="100" nuserdata="1000000"/>',
                               '<replicate count="1900"><body><geom size="1"/></body>'
                               "</replicate>" + BALL),
            "hills.xml": model('<asset><hfield name="h" nrow="4000" ncol="4000" size="1 1 1 1"/>'
                               "</asset>"),
            "pictures.xml": model("<asset>" + "".join(
                f'<texture name="t{i}" type="2d" builtin="flat" width="20000" height="20000"/>'
                for i in range(20)) + "</asset>"),
            "numbers.xml": model("<custom>" + "".join(
                f'<numeric name="n{i}" size="100000" data="1"/>' for i in range(9)) + "</custom>"),
            "cloth.xml": model("", '<body name="c">' + grid + "</body>" + BALL),
            "sensor.xml": model('<sensor><user dim="1000000000"/></sensor>'),
            "camera.xml": model("", '<camera resolution="100000 100000"/>' + BALL),
            "sphere.xml": model('<asset><mesh name="m" builtin="sphere" params="10000"/></asset>'),
            "actuator.xml": model('<actuator><general joint="j" dyntype="user" actdim="1000000000"/>'
                                  "</actuator>", '<body><joint name="j"/><geom size="1"/></body>'),
            "classes.xml": model("<default>" + "".join(f"<default class='c{i}'/>"
                                                       for i in range(2000)) + "</default>"),
        }, ("robots", "check", "FILE"), ("robots", "add", "mine", "--model", "FILE", "--force"))

    def test_endless_pipes(self):
        of_robot = ("--robot", "unitree_g1")
        for command in (("evaluate", "-", *of_robot, "--memory", "0.1"),
                        ("convert", "-", "o.csv", *of_robot, "--memory", "0.1"),
                        ("compare", "-", sample("wave"), "--memory", "0.1"),
                        ("compare", "-", sample("wave"), *of_robot, "--memory", "0.1")):
            with self.subTest(command=command):
                read, write = os.pipe()
                with subprocess.Popen(["/bin/cat", "/dev/zero"], stdout=write) as feeder:
                    os.close(write)
                    try:
                        result = self.run_measured(*command, stdin=read)
                    finally:
                        os.close(read)
                        feeder.kill()
                self.assert_small(result)
                self.assertEqual(result.returncode, 3, result.stderr)
                self.assertIn("expected at most 25000000 bytes", " ".join(result.stderr.split()))
                self.assertIn("--memory", result.stderr)

    def test_endless_settings(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        run = ("--bvh", sample("wave"), "--robot", "unitree_g1", "-o", "o.csv")
        for command in ((*run, "--ik-config", pipe), (*run, "--fit-config", pipe),
                        (*run, "--map", pipe), ("verify", pipe)):
            with self.subTest(command=command):
                feeder = subprocess.Popen(["sh", "-c", 'exec cat /dev/zero > "$0"', pipe])
                try:
                    result = self.run_measured(*command)
                finally:
                    feeder.kill()
                    feeder.wait()
                self.assert_small(result)
                self.assertIn(result.returncode, (3, 4), result.stderr)


if __name__ == "__main__":
    unittest.main()
