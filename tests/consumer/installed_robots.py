"""Robots of an installed tree: installed_robots.py TREE BUILT-TOOL UNVERIFIED, the last 1 where the tree has all."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
INSTALLED, BUILT = pathlib.Path(sys.argv[1]), sys.argv[2]
HAS_ALL = sys.argv[3] == "1"
WAVE = SOURCE / "data/wave.bvh"


def run(folder, tool, *arguments, code=0):
    environment = {name: value for name, value in os.environ.items()
                   if name not in ("LD_LIBRARY_PATH", "RETARGET_DATA_DIR")}
    environment["XDG_DATA_HOME"] = str(folder / "own")
    result = subprocess.run([str(tool), *map(str, arguments)], cwd=folder, env=environment, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300, check=False)
    assert result.returncode == code, f"{arguments} ended with {result.returncode}:\n{result.stderr}"
    result.stderr = " ".join(result.stderr.split())
    return result


def main():
    folder = pathlib.Path(tempfile.mkdtemp(prefix="retarget installed "))
    try:
        tool = INSTALLED / "bin/retarget"
        listed = json.loads(run(folder, tool, "robots", "list", "--json").stdout)
        assert {robot["name"] for robot in listed} == {p.parent.name for p in SOURCE.glob("robots/**/model.xml")}
        unverified = {p.name for p in (SOURCE / "robots/unverified").iterdir()}
        for robot in listed:
            # Every install has the robots whose licence permits it.
            assert robot["installed"] == (HAS_ALL or robot["name"] not in unverified), robot
            assert robot["licence_stated"] == (robot["name"] not in unverified), robot

        # The full name of a robot that is not installed never matches another robot.
        data = folder / "share/retarget"
        shutil.copytree(INSTALLED / "share/retarget", data)
        shutil.rmtree(data / "robots/booster_t1")
        result = run(folder, tool, WAVE, "booster_t1", "-o", "x.csv", "--data-dir", data, code=4)
        assert "booster_t1 is not installed" in result.stderr, result.stderr
        assert "retarget robots install booster_t1 --source" in result.stderr, result.stderr
        assert not (folder / "x.csv").exists()
        if HAS_ALL:
            return
        result = run(folder, tool, WAVE, "booster_k1", "-o", "x.csv", code=4)
        assert "its maker states no licence" in result.stderr, result.stderr
        run(folder, tool, "robots", "install", "booster_k1", "--source", SOURCE)
        run(folder, tool, WAVE, "booster_k1", "-o", "x.csv")
        run(folder, BUILT, WAVE, "booster_k1", "-o", "expected.csv")
        assert (folder / "x.csv").read_bytes() == (folder / "expected.csv").read_bytes()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
