"""Every command in README.md and docs/ runs: those of a document one after the other, in a folder that has
the files they name."""

import json
import os
import re
import shutil
import struct
import subprocess
import unittest

from terrain_test import stepping_clip
from tool import SOURCE, TOOL, ToolTest, sample, short_clip

# Lines that cannot run here, and why.
CANNOT_RUN = {
    "seq 16 | parallel": "needs GNU parallel and two machines",
    "job=$(sbatch": "needs Slurm",
    "sbatch ": "needs Slurm",
}

# Commands that end with another code than 0, according to the text next to them.
EXIT_CODES = {
    "retarget evaluate ours.csv published.csv": (1,),  # The published motion misses gates.
    "retarget evaluate PUBLISHED.csv": (0, 1),  # A published motion may miss gates.
}

ROBOT = SOURCE / "robots/unitree_g1"
# Prefixes of lines that are shell commands.
COMMAND = re.compile(r"^(?:[A-Za-z_]+=\S+ +)*"
                     r"(retarget|tools/\S+|bench/\S+|cmake|ctest|sbatch|seq|python3|job=\S+)(?: |$)")


def documents():
    return [*sorted(SOURCE.glob("*.md")), *sorted((SOURCE / "docs").glob("*.md"))]


def code_lines(text):
    """Returns lines of indented and fenced code, with continued lines joined."""
    fenced, before, pending = False, "", ""
    for line in text.splitlines():
        if line.startswith("```"):
            fenced = not fenced
        elif fenced or (line.startswith("    ") and (before == "" or before.startswith("    "))):
            code = (pending + line.strip()).strip()
            pending = ""
            if code.endswith("\\"):
                pending = code[:-1]
            elif code:
                yield code
        before = line


def commands(document):
    return [line for line in code_lines(document.read_text()) if COMMAND.match(line)]


SMPL = ("pelvis left_hip right_hip spine1 left_knee right_knee spine2 left_ankle right_ankle spine3 "
        "left_foot right_foot neck left_collar right_collar head left_shoulder right_shoulder "
        "left_elbow right_elbow left_wrist right_wrist").split()
# Positions of these joints, metres, Y up, facing z.
STANDING = [
    (0, 0, 0), (.09, -.08, 0), (-.09, -.08, 0), (0, .11, 0), (.09, -.46, .02), (-.09, -.46, .02),
    (0, .25, 0), (.09, -.87, 0), (-.09, -.87, 0), (0, .31, 0), (.09, -.92, .12), (-.09, -.92, .12),
    (0, .52, 0), (.07, .43, 0), (-.07, .43, 0), (0, .62, 0), (.18, .45, 0), (-.18, .45, 0),
    (.3, .2, 0), (-.3, .2, 0), (.4, 0, .1), (-.4, 0, .1)]


def npy(table):
    """A file of a NumPy array of doubles."""
    shape, numbers = [], table
    while isinstance(numbers, list):
        shape.append(len(numbers))
        numbers = numbers[0]
    flat = table
    for _ in shape[1:]:
        flat = [item for part in flat for item in part]
    header = str({"descr": "<f8", "fortran_order": False, "shape": tuple(shape)})
    header += " " * (-(len(header) + 11) % 64) + "\n"
    return (b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode()
            + struct.pack(f"<{len(flat)}d", *flat))


def restore(files, folder):
    """Copies the files that are missing in a folder or differ there in size or time of modification."""
    def copy(source, target):
        before, now = (os.stat(path) if os.path.exists(path) else None for path in (source, target))
        if now is None or (before.st_size, before.st_mtime_ns) != (now.st_size, now.st_mtime_ns):
            shutil.copy2(source, target)

    shutil.copytree(files, folder, dirs_exist_ok=True, copy_function=copy,
                    ignore=shutil.ignore_patterns("commands"))


class Commands(ToolTest):
    def prepare(self):
        """Creates the input files of the documents' commands."""
        for name in ("walk", "IN", "CLIP", "A"):
            self.write(f"{name}.bvh", short_clip("walk", 150))
        for name in ("wave", "other", "OTHER", "T", "clip", "B", "C"):
            shutil.copy(sample("wave"), self.folder / f"{name}.bvh")
        text = sample("walk").read_text()
        self.write("bones.bvh", text[:text.index("MOTION")])
        for name in ("short.bvh", "clips/walk.bvh", "clips/more/wave.bvh"):
            self.write(name, short_clip("walk", 90))
        for folder in ("build", "golden"):
            (self.folder / folder).mkdir()
        for output, *options in (
                ("walk.csv", "--bvh", "walk.bvh", "--sidecar"),
                ("golden/walk.csv", "--bvh", "clips/walk.bvh"),
                ("motion.pkl", "--bvh", "short.bvh", "--format", "pkl-gmr"),
                *((name, "--bvh", "short.bvh", "--method", "gmr")
                  for name in ("a.csv", "b.csv", "old.csv", "new.csv", "PUBLISHED.csv"))):
            self.assert_done(self.run_tool("--robot", "unitree_g1", "-o", output, *options))
        shutil.copy(self.folder / "walk.csv", self.folder / "golden.csv")
        for name, file in (("character.fbx", "walk.fbx"), ("avatar.glb", "walk.glb")):
            shutil.copy(SOURCE / "tests/scene/data" / file, self.folder / name)
        (self.folder / "MESHES").mkdir()
        self.write("MESHES/left_knee_link.obj", "v 0 0 0\nv 0.1 0 0\nv 0 0 0.1\nf 1 2 3\n")
        for name in ("my_robot.xml", "my.xml"):
            shutil.copy(ROBOT / "model.xml", self.folder / name)
        shutil.copy(SOURCE / "configs/lafan1_to_unitree_g1.json", self.folder / "my_mapping.json")
        shutil.copytree(SOURCE / "data", self.folder / "data")
        shutil.copytree(SOURCE / "robots/unverified", self.folder / "SOURCE/robots/unverified")
        self.write_places()
        self.write_room()

    def write_room(self):
        """Writes a scene beside the walk, and a crate that moves through it."""
        box = [{"type": "box", "size": [0.3, 0.3, 0.3]}]
        bodies = [{"name": "step", "position": [0, 3, 0.1], "shapes": box},
                  {"name": "crate", "moves": True, "position": [0, -3, 1], "shapes": box}]
        self.write("room.json", json.dumps({"bodies": bodies}))
        self.write("climb.bvh", stepping_clip())
        ahead = {"name": "box", "position": [0, -0.6, 0.1],
                 "shapes": [{"type": "box", "size": [1, 0.6, 0.2]}]}
        self.write("boxes.json", json.dumps({"bodies": [ahead]}))
        frames = (self.folder / "walk.bvh").read_text().count("\n")
        self.write("crate.csv", "".join(f"{0.001 * i},-3,1,1,0,0,0\n" for i in range(frames)))

    def write_places(self):
        """Writes joint positions of a swaying body: HumanML3D's array, MDM's, one with names."""
        frames = [[[x + 0.002 * frame * y, y, z] for x, y, z in STANDING] for frame in range(20)]
        motion = [[[[frame[joint][axis] for frame in frames] for axis in range(3)]
                   for joint in range(22)]] * 3
        self.write("new_joints/000021.npy", npy(frames))
        self.write("results.npy", npy(motion))
        self.write("keypoints.npy", npy([frame[::-1] for frame in frames]))
        self.write("names.txt", "\n".join(SMPL[::-1]))

    def run_line(self, line):
        return subprocess.run(
            ["bash", "-o", "pipefail", "-c",
             'retarget() { "$RETARGET_TOOL" "$@"; }\n' + line.replace(" NAME", " unitree_g1")],
            cwd=self.folder, env=self.tool_environment(RETARGET_TOOL=TOOL), text=True, timeout=300,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def test_all_run(self):
        self.prepare()
        files, self.folder = self.folder, self.folder / "commands"
        ran = 0
        for document in documents():
            lines = [line for line in commands(document) if line.startswith("retarget ")]
            if not lines:
                continue
            shutil.rmtree(self.folder, ignore_errors=True)
            for line in lines:
                # A command may read the output of the one before, but the named files are restored.
                restore(files, self.folder)
                with self.subTest(document=document.name, command=line):
                    result = self.run_line(line)
                    codes = next((codes for start, codes in EXIT_CODES.items()
                                  if line.startswith(start)), (0,))
                    self.assertIn(result.returncode, codes, result.stderr)
                    self.assert_written(line)
                    ran += 1
        self.assertGreater(ran, 40)

    def assert_written(self, line):
        """The file that -o names exists."""
        for output in re.findall(r" -o (\S+)", line.split(" # ")[0]):
            if output == "-":
                continue
            path = self.folder / output
            found = path.exists() or list(path.parent.glob(path.name + "*"))
            self.assertTrue(found, f"{output} was not written")


class OtherLines(unittest.TestCase):
    """Lines that a test cannot run, such as builds and job arrays; their files must exist."""

    def test_programs_and_presets_exist(self):
        presets = {preset["name"] for preset in
                   json.loads((SOURCE / "CMakePresets.json").read_text())["configurePresets"]}
        for document in documents():
            for line in commands(document):
                with self.subTest(document=document.name, command=line):
                    for name in re.findall(r"(?:^|[\s;&(])((?:tools|bench|tests)/[\w/.]+)", line):
                        self.assertTrue((SOURCE / name).exists(), name)
                    for name in re.findall(r"--preset (\w+)", line):
                        self.assertIn(name, presets)

    def test_excluded_commands_occur_in_documents(self):
        every = [line for document in documents() for line in commands(document)]
        for start in CANNOT_RUN:
            self.assertTrue(any(line.startswith(start) for line in every), start)
        known = re.compile(r"^(retarget |tools/|bench/|cmake |ctest )|\bpython3 tests/|^(MuJoCo_ROOT|RETARGET_NO_PYTHON)=\S+ tools/")
        for line in every:
            if not known.search(line):
                self.assertTrue(any(line.startswith(start) for start in CANNOT_RUN), line)


class Links(unittest.TestCase):
    def test_files_that_documents_link_exist(self):
        for document in documents():
            for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", document.read_text()):
                if "://" not in target and not target.startswith("mailto:"):
                    self.assertTrue((document.parent / target).exists(), f"{document.name}: {target}")

    def test_every_page_is_linked_from_the_index(self):
        index = (SOURCE / "docs/README.md").read_text()
        for page in sorted((SOURCE / "docs").glob("*.md")):
            if page.name != "README.md":
                self.assertIn(f"({page.name})", index)


if __name__ == "__main__":
    unittest.main()
