"""The scripts of releases: lists of parts, the contents and tags of wheels, pinned sources."""

import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest
import unittest.mock

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def module(name):
    """A script of tools/ as a module."""
    spec = importlib.util.spec_from_file_location(name, SOURCE / f"tools/{name}.py")
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


def text(path):
    return (SOURCE / path).read_text(encoding="utf-8")


def rows(path):
    return [line.split() for line in text(path).splitlines() if not line.startswith("#")]


class PinnedSources(unittest.TestCase):
    def test_every_build_compiles_the_same_sources(self):
        release = rows("tools/release_sources.txt")
        for row in rows("tools/browser_sources.txt") + rows("tools/windows_sources.txt"):
            self.assertIn(row, release)
        for _, _, digest in release:
            self.assertRegex(digest, r"^[0-9a-f]{64}$")

    def test_every_source_is_compiled(self):
        build = text("tools/release_libraries.sh") + text("tools/release_libraries/CMakeLists.txt")
        for package, file, _ in rows("tools/release_sources.txt"):
            name = {"zeromq3": "libzmq"}.get(package, package)
            self.assertIn(f"{name}-[0-9]*", build, file)

    def test_the_old_glibc_is_that_of_the_documents(self):
        glibc = re.search(r"RETARGET_GLIBC ([\d.]+)\)", text("cmake/linux_release.cmake"))[1]
        self.assertIn(f"glibc {glibc}", text("docs/releases.md"))
        self.assertIn(f"manylinux_{glibc.replace('.', '_')}_ARCH.whl", text("docs/releases.md"))


@unittest.skipUnless(shutil.which("dpkg-query"), "versions of header-only libraries come from Debian's packages")
class Parts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.sbom = module("sbom")

    def document(self, arch="x86_64"):
        with unittest.mock.patch.dict(os.environ, SOURCE_DATE_EPOCH="1700000000"):
            return self.sbom.document(arch)

    def test_every_linked_library_is_listed_with_its_hashes(self):
        parts = {part["name"]: part for part in self.document()["components"]}
        for package, _, digest in rows("tools/release_sources.txt"):
            self.assertIn(digest, [each["content"] for each in parts[self.sbom.SOURCES[package]]["hashes"]])
        mujoco = re.findall(r"sha256:(\w+)", text("tools/mujoco.txt"))
        self.assertEqual([each["content"] for each in parts["MuJoCo"]["hashes"]], mujoco)
        for name in ("Eigen", "nanobind", "ufbx", "three.js", "unitree_g1"):
            self.assertIn(name, parts)

    def test_every_notice_has_its_part(self):
        listed = {part["name"] for part in self.document()["components"]}
        self.assertEqual(set(self.sbom.notices()) - {"Figures of robots"} - listed, set())

    def test_unlicensed_robots_are_no_part(self):
        listed = {part["name"] for part in self.document()["components"]}
        for folder in (SOURCE / "robots/unverified").iterdir():
            self.assertNotIn(folder.name, listed)

    def test_the_same_release_has_the_same_document(self):
        self.assertEqual(self.document(), self.document())
        self.assertNotEqual(self.document()["serialNumber"], self.document("aarch64")["serialNumber"])

    def test_a_part_without_a_notice_is_an_error(self):
        with self.assertRaisesRegex(SystemExit, "does not mention nothing"):
            self.sbom.component("nothing", "1", "nowhere")


class Wheel(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="retarget release "))
        self.addCleanup(shutil.rmtree, self.folder)
        self.wheel = module("make_wheel")

    def write(self, name, content=""):
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(content)

    def test_tags_name_the_pythons_whose_modules_exist(self):
        for suffix in ("cpython-310-x86_64-linux-gnu", "cpython-311-x86_64-linux-gnu", "abi3"):
            self.write(f"_retarget.{suffix}.so")
        self.assertEqual(self.wheel.module_tags(self.folder), (["cp310", "cp311", "cp312"], ["cp310", "cp311", "abi3"]))

    def test_a_wheel_without_modules_is_an_error(self):
        with self.assertRaisesRegex(SystemExit, "no module"):
            self.wheel.module_tags(self.folder)

    def tree(self):
        for name in ("bin/retarget", "lib/libretarget.so.0.1.0", "lib/retarget/libmujoco.so.4", "lib/retarget/LICENSE",
                     "lib/retarget/include/mujoco/mujoco.h", "share/retarget/robots/unitree_g1/model.xml", "include/retarget/clip.h"):
            self.write(f"tree/{name}", name)
        (self.folder / "tree/lib/libretarget.so.0.1").symlink_to("libretarget.so.0.1.0")
        (self.folder / "tree/lib/libretarget.so").symlink_to("libretarget.so.0.1")

    def test_the_library_is_in_the_wheel_once_under_the_name_that_is_loaded(self):
        self.tree()
        self.wheel.copy_tree(self.folder / "tree", self.folder / "package")
        found = sorted(str(file.relative_to(self.folder / "package")) for file in (self.folder / "package").rglob("*")
                       if file.is_file())
        self.assertEqual(found, ["bin/retarget", "lib/libretarget.so.0.1", "lib/retarget/LICENSE",
                                 "lib/retarget/libmujoco.so.4", "share/retarget/robots/unitree_g1/model.xml"])
        self.assertEqual((self.folder / "package/lib/libretarget.so.0.1").read_text(), "lib/libretarget.so.0.1.0")

    def test_an_incomplete_tree_is_an_error(self):
        self.tree()
        (self.folder / "tree/lib/retarget/libmujoco.so.4").unlink()
        with self.assertRaisesRegex(SystemExit, "lacks lib/retarget/libmujoco"):
            self.wheel.copy_tree(self.folder / "tree", self.folder / "package")


class Arguments(unittest.TestCase):
    def test_unknown_ones_are_rejected(self):
        for arguments, message in ((["--arch", "riscv"], "unknown architecture \"riscv\""), (["--fast"], "unknown option --fast")):
            result = subprocess.run(["bash", SOURCE / "tools/release.sh", *arguments], text=True, stderr=subprocess.PIPE,
                                    timeout=60, check=False)
            self.assertNotEqual(result.returncode, 0)
            self.assertIn(message, result.stderr)


if __name__ == "__main__":
    unittest.main()
