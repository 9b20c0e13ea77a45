"""Builds the command line and the Python module from an installed tree: build_clients.py --installed TREE ...

The clients use the library as any other program does. Their sources are copied to a place outside of the
source tree and compiled against the installed headers and libraries. The source tree is hidden meanwhile
where the system allows it. The command line is then linked and run; the Python module is only compiled."""

import argparse
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import sysconfig
import tempfile

from run_examples import SOURCE, hiding_command

CLIENTS = ("tools/retarget", "python/src")


def python_headers(folder):
    """Folders with the headers of Python and nanobind, outside of the source tree; empty: not installed."""
    python = pathlib.Path(sysconfig.get_path("include"))
    sys.path.append(str(SOURCE / "build/deps/python"))
    found = importlib.util.find_spec("nanobind")
    if found is None or not (python / "Python.h").is_file():
        return []
    copy = folder / "nanobind"
    shutil.copytree(pathlib.Path(found.origin).parent / "include", copy)
    return [copy, python]


def run(command, folder, hide=()):
    environment = {name: value for name, value in os.environ.items()
                   if name not in ("RETARGET_DATA_DIR", "LD_LIBRARY_PATH", "CMAKE_PREFIX_PATH")}
    result = subprocess.run([*hide, *map(str, command)], text=True, cwd=folder, env=environment,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, timeout=800)
    assert result.returncode == 0, f"{command} ended with {result.returncode}:\n{result.stdout[-6000:]}"
    return result.stdout


def build(folder, arguments):
    installed = folder / "installed tree"
    shutil.copytree(arguments.installed, installed, symlinks=True)
    shutil.copy(pathlib.Path(__file__).parent / "clients/CMakeLists.txt", folder)
    for client in CLIENTS:
        shutil.copytree(SOURCE / client, folder / client)
    headers = python_headers(folder)
    if not headers:
        print("the Python module is left out: nanobind or the headers of Python are missing")
    # A MuJoCo that is not part of the installed tree may be in the source tree.
    bundled = any(installed.glob("lib*/**/retarget/include/mujoco/mujoco.h"))
    hide = hiding_command() if bundled else []
    if not hide:
        print("the source tree is not hidden: the system does not allow it, or MuJoCo lies there")
    run([arguments.cmake, "-S", ".", "-B", "build", "-G", arguments.generator,
         f"-DCMAKE_PREFIX_PATH={installed}", f"-DEXPECTED_PREFIX={installed}",
         "-DPYTHON_INCLUDES=" + ";".join(map(str, headers)), *arguments.settings], folder, hide)
    run([arguments.cmake, "--build", "build", "--parallel", "2"], folder, hide)
    return hide


def use_command_line(folder, hide):
    tool = folder / "build/retarget"
    assert "retarget " in run([tool, "--version"], folder, hide)
    shutil.copy(SOURCE / "data/wave.bvh", folder)
    run([tool, "wave.bvh", "unitree_g1", "--method", "gmr", "--end", "0.5", "-q", "-o", "wave.csv"], folder, hide)
    rows = (folder / "wave.csv").read_text().splitlines()
    assert len(rows) > 10 and all(len(row.split(",")) == 7 + 29 for row in rows), rows[:2]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--installed", required=True, type=pathlib.Path)
    parser.add_argument("--cmake", required=True)
    parser.add_argument("--generator", required=True)
    parser.add_argument("settings", nargs="*")
    arguments = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="retarget clients ")).resolve()
    assert SOURCE not in folder.parents, f"{folder} lies in the source tree: set TMPDIR"
    try:
        use_command_line(folder, build(folder, arguments))
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
