"""Runs the built examples: run_examples.py FOLDER-OF-PROGRAMS [TOOL]"""

import pathlib
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = pathlib.Path(sys.argv[1]).resolve()
TOOL = sys.argv[2] if len(sys.argv) > 2 else ""


def run(folder, program, *arguments, code=0):
    result = subprocess.run([program, *arguments], cwd=folder, text=True, timeout=300,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert result.returncode == code, f"{program} ended with {result.returncode}:\n{result.stderr}"
    return result.stdout


def main():
    folder = pathlib.Path(tempfile.mkdtemp(prefix="retarget examples "))
    try:
        wave = SOURCE / "data/wave.bvh"
        run(folder, PROGRAMS / "01_bvh_to_csv", wave, "unitree_g1", "wave.csv")
        if TOOL:
            # defaults are those of the command line
            run(folder, TOOL, wave, "unitree_g1", "-q", "-o", "by_tool.csv")
            assert (folder / "wave.csv").read_bytes() == (folder / "by_tool.csv").read_bytes()

        shutil.copy(SOURCE / "robots/unitree_g1/model.xml", folder / "my_robot.xml")
        run(folder, PROGRAMS / "02_own_robot", "my_robot.xml", wave, "own.csv")
        assert (folder / "my_robot/ik.json").is_file() and (folder / "own.csv").is_file()

        report = run(folder, PROGRAMS / "03_stages_by_hand", wave, "unitree_g1", "part.csv")
        assert "jumps" in report, report
        # two seconds at 60 frames per second
        assert len((folder / "part.csv").read_text().splitlines()) == 121

        for clip in ("a.bvh", "more/b.bvh"):
            (folder / "clips" / clip).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(wave, folder / "clips" / clip)
        run(folder, PROGRAMS / "04_whole_folder", "clips", "unitree_g1", "out")
        (folder / "clips/bad.bvh").write_text("HIERARCHY\n")
        run(folder, PROGRAMS / "04_whole_folder", "clips", "unitree_g1", "again", code=1)
        for out in ("out/a.csv", "out/more/b.csv", "again/more/b.csv"):
            assert (folder / out).read_bytes() == (folder / "wave.csv").read_bytes(), out
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
