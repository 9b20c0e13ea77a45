"""Builds and runs the C++ examples as another project would: run_examples.py --installed TREE ...

The installed tree is copied to a new place, and everything is built and run next to it, outside of
the source tree, which is hidden meanwhile where the system allows it. So it also works on a machine
with only the installed tree."""

import argparse
import os
import pathlib
import shutil
import subprocess
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
ROBOT = "unitree_g1"


def hiding_command():
    """Mounts an empty folder over the source tree for one command; empty if not permitted."""
    command = ["unshare", "--mount", "--map-root-user", "sh", "-c",
               'mount -t tmpfs none "$0" && exec "$@"', str(SOURCE)]
    try:
        seen = subprocess.run([*command, "ls", str(SOURCE)], stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, check=True, timeout=60).stdout
    except (OSError, subprocess.SubprocessError):
        return []
    assert not seen, f"the source tree is still there: {seen}"
    return command


class Sandbox:
    def __init__(self, folder, installed):
        self.folder = folder
        self.installed = folder / "installed tree"
        self.build = folder / "build"
        shutil.copytree(installed, self.installed, symlinks=True)
        shutil.copytree(SOURCE / "examples", folder / "examples")
        shutil.copy(SOURCE / "data/wave.bvh", folder)
        shutil.copy(SOURCE / "robots" / ROBOT / "model.xml", folder / "my_robot.xml")
        # A MuJoCo that is not part of the installed tree may be in the source tree.
        bundled = any(self.installed.glob("lib*/**/retarget/include/mujoco/mujoco.h"))
        self.hide = hiding_command() if bundled else []
        if not self.hide:
            print("the source tree is not hidden: the system does not allow it, or MuJoCo lies there")

    def run(self, *command, code=0, hide=True):
        environment = {name: value for name, value in os.environ.items()
                       if name not in ("RETARGET_DATA_DIR", "LD_LIBRARY_PATH", "CMAKE_PREFIX_PATH")}
        result = subprocess.run([*(self.hide if hide else []), *map(str, command)], text=True,
                                cwd=self.folder, env=environment, timeout=600,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        assert result.returncode == code, (
            f"{command} ended with {result.returncode}:\n{result.stdout[-4000:]}\n{result.stderr}")
        return result.stdout

    def example(self, name, *arguments, code=0):
        return self.run(self.build / name, *arguments, code=code)

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()


def build(box, cmake, generator, settings):
    box.run(cmake, "-S", "examples", "-B", box.build, "-G", generator,
            f"-DCMAKE_PREFIX_PATH={box.installed}", *settings)
    box.run(cmake, "--build", box.build)
    sources = sorted(path.stem for path in (box.folder / "examples").glob("*.cpp"))
    # A new example needs a run below.
    assert sources == ["01_bvh_to_csv", "02_own_robot", "03_stages_by_hand", "04_whole_folder"], sources


def run_single_clip(box, tool):
    summary = box.example("01_bvh_to_csv", "wave.bvh", ROBOT, "wave.csv")
    assert ROBOT in summary, summary
    rows = box.bytes_of("wave.csv").decode().splitlines()
    assert len(rows) > 60 and all(len(row.split(",")) == 7 + 29 for row in rows), rows[:2]
    if tool:
        # The defaults are those of the command line.
        box.run(tool, "wave.bvh", ROBOT, "-q", "-o", "by_tool.csv", hide=False)
        assert box.bytes_of("wave.csv") == box.bytes_of("by_tool.csv")


def run_own_robot(box):
    box.example("02_own_robot", "my_robot.xml", "wave.bvh", "own.csv")
    assert (box.folder / "my_robot/ik.json").is_file()
    assert len(box.bytes_of("own.csv").splitlines()) == len(box.bytes_of("wave.csv").splitlines())


def run_stages(box):
    report = box.example("03_stages_by_hand", "wave.bvh", ROBOT, "part.csv")
    assert "jumps" in report, report
    # Two seconds at 60 frames per second.
    assert len(box.bytes_of("part.csv").splitlines()) == 121


def run_folder(box):
    for clip in ("a.bvh", "more/b.bvh"):
        (box.folder / "clips" / clip).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(box.folder / "wave.bvh", box.folder / "clips" / clip)
    box.example("04_whole_folder", "clips", ROBOT, "out")
    (box.folder / "clips/bad.bvh").write_text("HIERARCHY\n")
    box.example("04_whole_folder", "clips", ROBOT, "again", code=1)
    for out in ("out/a.csv", "out/more/b.csv", "again/more/b.csv"):
        assert box.bytes_of(out) == box.bytes_of("wave.csv"), out


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--installed", required=True, type=pathlib.Path)
    parser.add_argument("--cmake", required=True)
    parser.add_argument("--generator", required=True)
    parser.add_argument("--tool", default="")
    parser.add_argument("settings", nargs="*")
    arguments = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="retarget examples ")).resolve()
    assert SOURCE not in folder.parents, f"{folder} lies in the source tree: set TMPDIR"
    try:
        box = Sandbox(folder, arguments.installed)
        build(box, arguments.cmake, arguments.generator, arguments.settings)
        run_single_clip(box, arguments.tool)
        run_own_robot(box)
        run_stages(box)
        run_folder(box)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
