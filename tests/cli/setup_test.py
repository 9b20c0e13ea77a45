"""tools/setup.sh takes the MuJoCo wheel whose hash it knows, and no other."""

import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]


class Wheel(unittest.TestCase):
    def setUp(self):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="it's a test "))
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        self.tree = folder / "tree"
        shutil.copytree(SOURCE / "tools", self.tree / "tools",
                        ignore=shutil.ignore_patterns("retarget", "samples"))
        # pip takes a blank for the end of a folder's name
        self.index = pathlib.Path(tempfile.mkdtemp(prefix="retarget_wheels_"))
        self.addCleanup(shutil.rmtree, self.index, ignore_errors=True)
        self.environment = {k: v for k, v in os.environ.items()
                            if k not in ("MuJoCo_ROOT", "MUJOCO_DIR", "mujoco_DIR")}
        self.environment.update(PIP_NO_INDEX="1", PIP_FIND_LINKS=str(self.index),
                                PIP_CONFIG_FILE=os.devnull)
        # with a MuJoCo of one's own: whether anything else is missing
        rest = self.setup("--check", MuJoCo_ROOT=str(folder))
        if rest.returncode != 0:
            self.skipTest("not all that setup.sh would install is there: " + rest.stderr)

    def setup(self, *arguments, **variables):
        return subprocess.run(["bash", self.tree / "tools/setup.sh", *arguments], text=True,
                              stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, timeout=300,
                              env={**self.environment, **variables})

    def add_wheel(self, package, version):
        """A wheel that looks like MuJoCo's; gives its hash."""
        name = f"{package}-{version}"
        path = self.index / f"{name}-py3-none-any.whl"
        files = {"mujoco/include/mujoco/mujoco.h": "", f"mujoco/libmujoco.so.{version}": "",
                 f"{name}.dist-info/WHEEL": "Wheel-Version: 1.0\nGenerator: test\n"
                                            "Root-Is-Purelib: true\nTag: py3-none-any\n",
                 f"{name}.dist-info/METADATA": f"Metadata-Version: 2.1\nName: {package}\n"
                                               f"Version: {version}\n"}
        record = f"{name}.dist-info/RECORD"
        files[record] = "".join(f"{file},,\n" for file in [*files, record])
        with zipfile.ZipFile(path, "w") as archive:
            for file, text in files.items():
                archive.writestr(file, text)
        return hashlib.sha256(path.read_bytes()).hexdigest()

    def pin(self, file, requirement, digest):
        (self.tree / "tools" / file).write_text(f"{requirement} --hash=sha256:{digest}\n")

    def assert_nothing_installed(self, result):
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("Nothing was installed", result.stderr)
        deps = self.tree / "build/deps"
        self.assertEqual(list(deps.iterdir()) if deps.is_dir() else [], [])

    def test_another_wheel_of_the_same_version_is_refused(self):
        digest = self.add_wheel("mujoco_core", "4.0.0")
        result = self.setup()
        self.assert_nothing_installed(result)
        self.assertIn(digest, result.stderr)
        # the same call takes it once its hash is the pinned one
        self.pin("mujoco.txt", "mujoco-core==4.0.0", digest)
        result = self.setup()
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.tree / "build/deps/mujoco/libmujoco.so.4.0.0").exists())
        self.assertEqual([f.name for f in (self.tree / "build/deps").iterdir()], ["mujoco"])

    def test_no_other_version_without_being_asked_for(self):
        self.pin("mujoco_older.txt", "mujoco==3.3.7", self.add_wheel("mujoco", "3.3.7"))
        result = self.setup()
        self.assert_nothing_installed(result)
        self.assertIn("--older-mujoco", result.stderr)
        result = self.setup("--older-mujoco")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.tree / "build/deps/mujoco/libmujoco.so.3.3.7").exists())

    def test_every_pin_has_hashes_for_the_platforms_of_the_readme(self):
        for file in ("mujoco.txt", "mujoco_older.txt"):
            text = (SOURCE / "tools" / file).read_text()
            self.assertGreaterEqual(text.count("--hash=sha256:"), 2, file)


class TheDocsAgree(unittest.TestCase):
    """docs/building.md and docs/dependencies.md against the scripts that CI runs."""

    def text(self, name):
        return (SOURCE / name).read_text(encoding="utf-8")

    def test_the_packages_are_those_that_setup_installs(self):
        script = self.text("tools/setup.sh")
        tables = re.findall(r"^readonly k\w*Packages='\n(.*?)'", script, re.DOTALL | re.MULTILINE)
        self.assertEqual(len(tables), 4)
        wanted = [row.split("|")[0].strip() for table in tables for row in table.splitlines()]
        listed = self.text("docs/building.md").split("of developers (`tools/setup.sh`")[1]
        block = re.search(r"\n\n((?:    .*\n)+)", listed)[1]
        self.assertEqual(block.split(), wanted)

    def test_every_library_of_cmake_has_its_version_and_reason(self):
        told = {"Eigen3": "Eigen", "nlohmann_json": "nlohmann-json", "LibZip": "libzip", "ZLIB": "zlib",
                "OpenSSL": "OpenSSL's libcrypto", "GTest": "GoogleTest", "benchmark": "Google Benchmark",
                "Python3": "Python 3", "Python": "Python's headers", "Threads": None}
        rows = self.text("docs/dependencies.md")
        for file in ("CMakeLists.txt", "tools/retarget/CMakeLists.txt", "tests/CMakeLists.txt",
                     "bench/CMakeLists.txt", "python/CMakeLists.txt"):
            for name, version in re.findall(r"find_package\((\S+?)(?: ([\d.]+))?[ )]", self.text(file)):
                with self.subTest(name):
                    name = told.get(name, name)
                    if name:
                        self.assertRegex(rows, rf"\n\| {re.escape(name)}[^|]* \| {version or 'any'}\b")

    def test_the_module_is_built_with_one_nanobind(self):
        pinned = re.search(r"^nanobind==(\S+)", self.text("tools/python.txt"), re.MULTILINE)[1]
        self.assertIn(f'"nanobind=={pinned}"', self.text("pyproject.toml"))
        self.assertIn(f"; {pinned} is fetched |", self.text("docs/dependencies.md"))

    def test_ci_runs_the_checks_that_are_told(self):
        checks = re.search(r"RETARGET_CI_CHECKS-([\w -]+)}", self.text(".ci/run"))[1]
        page = self.text("docs/building.md")
        self.assertIn(f"`.ci/run` runs `tools/check.sh {checks}`, then `tools/test.sh`", page)
        options = re.findall(r"^option\((RETARGET_\w+)", self.text("CMakeLists.txt"), re.MULTILINE)
        for option in options:
            self.assertIn(f"| `{option}` |", page)


if __name__ == "__main__":
    unittest.main()
