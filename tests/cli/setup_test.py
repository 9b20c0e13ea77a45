"""tools/setup.sh installs the pinned MuJoCo wheel and selects one complete Python."""

import functools
import hashlib
import importlib.util
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
import zipfile

from tool import absent

SOURCE = pathlib.Path(__file__).resolve().parents[2]


class Strict(unittest.TestCase):
    """RETARGET_STRICT_TESTS: the dependencies of all other tests are installed (.ci/run)."""

    def test_setup_installs_every_test_dependency(self):
        if os.environ.get("RETARGET_STRICT_TESTS", "0") in ("", "0"):
            self.skipTest("RETARGET_STRICT_TESTS is not set")
        result = subprocess.run(["bash", SOURCE / "tools/setup.sh", "--check"], text=True,
                                stderr=subprocess.PIPE, timeout=300)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIsNotNone(importlib.util.find_spec("numpy"), f"{sys.executable} lacks numpy")

    def test_strict_mode_fails_for_missing_dependencies(self):
        with unittest.mock.patch.dict(os.environ, RETARGET_STRICT_TESTS="1"):
            with self.assertRaisesRegex(AssertionError, "no browser"):
                absent("no browser")
        for value in ("", "0"):
            with unittest.mock.patch.dict(os.environ, RETARGET_STRICT_TESTS=value):
                with self.assertRaisesRegex(unittest.SkipTest, "no browser"):
                    absent("no browser")


@functools.cache
def missing_packages():
    """Returns the missing packages besides MuJoCo according to setup.sh."""
    result = subprocess.run(["bash", SOURCE / "tools/setup.sh", "--check"], text=True, stderr=subprocess.PIPE,
                            timeout=300, env={**os.environ, "MuJoCo_ROOT": str(SOURCE)})
    return result.stderr or "something" if result.returncode else ""


class Setup(unittest.TestCase):
    """A copy of tools/ in a separate tree, and a folder as wheel index."""

    def setUp(self):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="it's a test "))
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        self.tree = folder / "tree"
        shutil.copytree(SOURCE / "tools", self.tree / "tools",
                        ignore=shutil.ignore_patterns("retarget", "samples"))
        # pip ends a folder name at a blank.
        self.index = pathlib.Path(tempfile.mkdtemp(prefix="retarget_wheels_"))
        self.addCleanup(shutil.rmtree, self.index, ignore_errors=True)
        self.environment = {k: v for k, v in os.environ.items()
                            if k not in ("MuJoCo_ROOT", "MUJOCO_DIR", "mujoco_DIR",
                                         "RETARGET_PYTHON", "RETARGET_NO_PYTHON")}
        self.environment.update(PIP_NO_INDEX="1", PIP_FIND_LINKS=str(self.index),
                                PIP_CONFIG_FILE=os.devnull)
        if missing_packages():
            absent("packages that setup.sh would install are missing: " + missing_packages())

    def setup(self, *arguments, **variables):
        return subprocess.run(["bash", self.tree / "tools/setup.sh", *arguments], text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, timeout=300,
                              env={**self.environment, **variables})


class Wheel(Setup):
    def add_wheel(self, package, version):
        """Adds a wheel that looks like MuJoCo's; returns its hash."""
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
        # The same call accepts it once its hash is pinned.
        self.pin("mujoco.txt", "mujoco-core==4.0.0", digest)
        result = self.setup()
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.tree / "build/deps/mujoco/libmujoco.so.4.0.0").exists())
        self.assertEqual([f.name for f in (self.tree / "build/deps").iterdir()], ["mujoco"])

    def test_other_versions_need_an_option(self):
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


FAKE_PYTHON = """#!/bin/sh
case "$*" in
  *sys.executable*) echo "$0" ;;
  *"version_info[:2]"*) echo {version} ;;
  {lacks}) exit 1 ;;
esac
"""


class OnePython(Setup):
    """One Python must meet all requirements."""

    CODES = {"numpy": "*numpy*", "headers": "*Python.h*", "venv": "*ensurepip*", "pip": "*import?pip*",
             "fetches": "*-m?pip*"}

    def python(self, *lacks, version="3.11"):
        """Returns a program that imitates a Python without some packages."""
        path = self.tree / "-".join(["python", version, *lacks])
        codes = [self.CODES[name] for name in lacks] or ["nothing"]
        path.write_text(FAKE_PYTHON.format(version=version, lacks="|".join(codes)))
        path.chmod(0o755)
        return str(path)

    def setup_python(self, *arguments, **variables):
        """Runs setup with a user's MuJoCo."""
        return self.setup("--python", *arguments, MuJoCo_ROOT=str(self.tree), **variables)

    def unpack(self, *left_out):
        """A folder that looks like the installed tools of tools/python.txt."""
        pinned = re.findall(r"^(\w+)==(\S+)", (SOURCE / "tools/python.txt").read_text(), re.MULTILINE)
        for name, version in pinned:
            if name not in left_out:
                (self.tree / f"build/deps/python/{name}-{version}.dist-info").mkdir(parents=True)

    def test_first_complete_python_is_used(self):
        whole = self.python()
        self.assertEqual(self.setup_python("--print-python", PYTHON=whole).stdout.strip(), whole)
        for lack in ("numpy", "headers", "venv", "pip"):
            lame = self.python(lack)
            with self.subTest(lack):
                taken = self.setup_python("--print-python", PYTHON=lame)
                self.assertEqual(taken.returncode, 0, taken.stderr)
                self.assertNotEqual(taken.stdout.strip(), lame)

    def test_a_wheel_needs_no_numpy(self):
        python = self.python("numpy")
        taken = self.setup_python("--tool", "--print-python", PYTHON=python)
        self.assertEqual(taken.stdout.strip(), python)

    def test_named_python_is_used_or_rejected(self):
        whole = self.python()
        taken = self.setup_python("--print-python", RETARGET_PYTHON=whole, PYTHON=self.python("numpy"))
        self.assertEqual(taken.stdout.strip(), whole)
        for lack in ("numpy", "headers", "venv", "pip"):
            with self.subTest(lack):
                result = self.setup_python(RETARGET_PYTHON=self.python(lack))
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertRegex(result.stderr, f"lacks: .*{lack}")
        result = self.setup_python(RETARGET_PYTHON=str(self.tree / "nothing"))
        self.assertEqual(result.returncode, 1)
        self.assertIn("which is not a Python interpreter", result.stderr)

    def test_pip_is_not_needed_with_installed_tools(self):
        self.unpack()
        result = self.setup_python("--check", RETARGET_PYTHON=self.python("pip"))
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_markers_of_older_pythons_count_for_them_alone(self):
        text = (SOURCE / "tools/python.txt").read_text()
        for line in re.findall(r"^\w.*", text, re.MULTILINE):
            self.assertRegex(line, r'^[a-z_]+==[0-9.]+( ; python_version < "3\.\d+")? \\$')
        self.assertRegex(text, r"(?m)^tomli==.*python_version")
        self.unpack("tomli", "exceptiongroup")
        new, old = self.python(), self.python(version="3.10")
        self.assertEqual(self.setup_python("--check", RETARGET_PYTHON=new).returncode, 0)
        self.assertEqual(self.setup_python("--check", RETARGET_PYTHON=old).returncode, 1)

    def test_failed_fetch_names_the_workaround(self):
        result = self.setup_python("--tool", RETARGET_PYTHON=self.python("fetches"))
        self.assertEqual(result.returncode, 1)
        self.assertIn("RETARGET_NO_PYTHON=1 tools/test.sh", result.stderr)
        self.assertEqual(list((self.tree / "build/deps").iterdir()), [])

    def test_tests_can_run_without_the_module(self):
        programs = self.tree / "programs"
        programs.mkdir()
        for name in ("cmake", "ctest"):
            (programs / name).write_text(f'#!/bin/sh\necho {name} "$@"\n')
            (programs / name).chmod(0o755)
        (self.tree / "tools/setup.sh").write_text('echo setup "$@" >&2\necho a_python\n')
        calls = {}
        for value in ("", "0", "1"):
            calls[value] = subprocess.run(
                ["bash", self.tree / "tools/test.sh"], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                check=True, env={**self.environment, "RETARGET_NO_PYTHON": value,
                                 "PATH": f"{programs}:{os.environ['PATH']}"})
        self.assertEqual(calls["1"].stderr.splitlines(), ["setup", "setup --print-python"])
        self.assertEqual(calls["0"].stderr.splitlines(), ["setup --python", "setup --python --print-python"])
        self.assertEqual(calls[""].stdout, calls["0"].stdout)
        for value, module in (("1", "OFF"), ("0", "ON")):
            self.assertRegex(calls[value].stdout, f"RETARGET_BUILD_PYTHON={module} .*RETARGET_PYTHON=a_python")


class TheDocsAgree(unittest.TestCase):
    """docs/building.md and docs/dependencies.md against the scripts that CI runs."""

    def text(self, name):
        return (SOURCE / name).read_text(encoding="utf-8")

    def test_the_packages_are_those_that_setup_installs(self):
        script = self.text("tools/setup.sh")
        tables = re.findall(r"^readonly k\w*Packages='\n(.*?)'", script, re.DOTALL | re.MULTILINE)
        self.assertEqual(len(tables), 5)
        wanted = [row.split("|")[0].strip() for table in tables for row in table.splitlines()]
        listed = self.text("docs/building.md").split("of developers (`tools/setup.sh`")[1]
        block = re.search(r"\n\n((?:    .*\n)+)", listed)[1]
        self.assertEqual(block.split(), wanted)

    def test_packages_of_npm_run_no_scripts_when_they_are_installed(self):
        calls = []
        for file in [*(SOURCE / "tools").rglob("*.sh"), SOURCE / ".ci/run"]:
            calls += re.findall(r"^[^#\n]*\bnpm (?:ci|i|install|add)\b.*(?:\\\n.*)*",
                                file.read_text(encoding="utf-8"), re.MULTILINE)
        self.assertGreaterEqual(len(calls), 2)
        for call in calls:
            self.assertIn("--ignore-scripts", call)

    def test_every_library_of_cmake_has_its_version_and_reason(self):
        cmake_names = {"Eigen3": "Eigen", "nlohmann_json": "nlohmann-json", "LibZip": "libzip", "ZLIB": "zlib",
                       "GTest": "GoogleTest", "benchmark": "Google Benchmark",
                       "Python3": "Python 3", "Python": "Python's headers", "Threads": None}
        rows = self.text("docs/dependencies.md")
        for file in ("CMakeLists.txt", "tools/retarget/CMakeLists.txt", "tests/CMakeLists.txt",
                     "bench/CMakeLists.txt", "python/CMakeLists.txt"):
            for name, version in re.findall(r"find_package\((\S+?)(?: ([\d.]+))?[ )]", self.text(file)):
                with self.subTest(name):
                    name = cmake_names.get(name, name)
                    if name:
                        self.assertRegex(rows, rf"\n\| {re.escape(name)}[^|]* \| {version or 'any'}\b")

    def test_linked_libraries_have_their_notice(self):
        rows = self.text("docs/dependencies.md").split("## Libraries")[1].split("\n\n")[1].splitlines()[2:]
        notices = dict(re.findall(r"^={78}\n(.*)\n\nLicence: (.*)", self.text("THIRD_PARTY_NOTICES"), re.MULTILINE))
        required = []
        for row in rows:
            name, _, licence, where = (cell.strip() for cell in row.split("|")[1:5])
            if re.search(r"core|edit|rig|batch|tool|pages|Python module", where) and name != "Python's headers":
                with self.subTest(name):
                    required.append(name)
                    self.assertIn(licence.split()[0], notices.get(name, "no notice"))
        self.assertGreaterEqual(len(required), 12)
        notice = self.text("THIRD_PARTY_NOTICES").split("Figures of robots")[1]
        for profile in (SOURCE / "robots").glob("*/robot.json"):
            self.assertIn(json.loads(profile.read_text())["licence"], notice)

    def test_the_module_is_built_with_one_nanobind(self):
        pinned = re.search(r"^nanobind==(\S+)", self.text("tools/python.txt"), re.MULTILINE)[1]
        self.assertIn(f'"nanobind=={pinned}"', self.text("pyproject.toml"))
        self.assertIn(f"; {pinned} is fetched |", self.text("docs/dependencies.md"))

    def test_ci_runs_the_documented_checks(self):
        checks = re.search(r"RETARGET_CI_CHECKS-([\w -]+)}", self.text(".ci/run"))[1]
        page = self.text("docs/building.md")
        self.assertIn(f"`.ci/run` runs `tools/check.sh {checks}`, then `tools/test.sh`", page)
        options = re.findall(r"^option\((RETARGET_\w+)", self.text("CMakeLists.txt"), re.MULTILINE)
        for option in options:
            self.assertIn(f"| `{option}` |", page)


if __name__ == "__main__":
    unittest.main()
