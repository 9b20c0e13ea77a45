"""Makes the wheel of a release: make_wheel.py --tree TREE --modules FOLDER --arch ARCH --glibc 2.28 -o FOLDER

TREE is an installed tree with the shared library; FOLDER has the modules for each Python and their stubs
(tools/release.sh). The same input gives the same bytes: entries are sorted, and their time is
SOURCE_DATE_EPOCH.

One wheel serves all versions of CPython: beside the module for the stable ABI (3.12 and later) it has one for each older
version, and each Python takes the first that fits its own names.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent
# The parts of the tree that pip installs: command, library, data. No headers, documents or packages of CMake.
TREE_PARTS = ("bin/retarget", "lib/libretarget.so.*", "lib/retarget/libmujoco*", "lib/retarget/LICENSE*",
              "share/retarget/**/*")


def version() -> str:
    return re.search(r"project\(retarget VERSION ([0-9.]+)", (SOURCE / "CMakeLists.txt").read_text())[1]


def copy_file(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(source, target)


def copy_tree(tree: Path, package: Path) -> None:
    """Copies the parts of the installed tree. A wheel has no links, so the library has the name that the loader uses."""
    for pattern in TREE_PARTS:
        found = [file for file in tree.glob(pattern) if file.is_file()]
        if not found:
            sys.exit(f"make_wheel: {tree} lacks {pattern}")
        for file in found:
            if not (file.is_symlink() or pattern.startswith("lib/libretarget")):
                copy_file(file, package / file.relative_to(tree))
    # The loaded name is the link libretarget.so.0.1, its file libretarget.so.0.1.0.
    (loaded,) = [file for file in tree.glob("lib/libretarget.so.*") if file.is_symlink()]
    copy_file(loaded.resolve(), package / "lib" / loaded.name)


def copy_python(modules: Path, package: Path) -> None:
    for file in sorted((SOURCE / "python/retarget").rglob("*")):
        if file.suffix == ".py" or file.name == "py.typed":
            copy_file(file, package / file.relative_to(SOURCE / "python/retarget"))
    for file in [*modules.glob("_retarget.*.so"), *modules.glob("*.pyi")]:
        copy_file(file, package / file.name)


def module_tags(modules: Path) -> tuple[list[str], list[str]]:
    """Returns the interpreter tags and ABI tags of all modules."""
    names = [file.name for file in modules.glob("_retarget.*.so")]
    older = sorted({f"cp{found[1]}" for name in names if (found := re.search(r"\.cpython-(\d+)-", name))})
    stable = any(name.endswith(".abi3.so") for name in names)
    if not names:
        sys.exit(f"make_wheel: there is no module in {modules}")
    return older + ["cp312"] * stable, older + ["abi3"] * stable


def write_metadata(folder: Path, tags: list[str]) -> None:
    import tomllib  # Python 3.11
    import pyproject_metadata
    with (SOURCE / "pyproject.toml").open("rb") as file:
        project = tomllib.load(file)
    scripts = project["project"]["scripts"]
    metadata = pyproject_metadata.StandardMetadata.from_pyproject(project, SOURCE)
    metadata.version = pyproject_metadata.packaging.version.Version(version())
    metadata.dynamic = []
    folder.mkdir()
    (folder / "METADATA").write_bytes(bytes(metadata.as_rfc822()))
    lines = ["Wheel-Version: 1.0", "Generator: retarget tools/make_wheel.py", "Root-Is-Purelib: false"]
    (folder / "WHEEL").write_text("\n".join(lines + [f"Tag: {tag}" for tag in tags]) + "\n")
    commands = "".join(f"{name} = {entry}\n" for name, entry in scripts.items())
    (folder / "entry_points.txt").write_text(f"[console_scripts]\n{commands}")
    for name in ("LICENSE", "THIRD_PARTY_NOTICES"):
        copy_file(SOURCE / name, folder / "licenses" / name)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--tree", type=Path, required=True)
    parser.add_argument("--modules", type=Path, required=True)
    parser.add_argument("--arch", required=True)
    parser.add_argument("--glibc", required=True)
    parser.add_argument("-o", "--output", type=Path, required=True)
    arguments = parser.parse_args()
    platform = f"manylinux_{arguments.glibc.replace('.', '_')}_{arguments.arch}"
    interpreters, abis = module_tags(arguments.modules)
    tags = [f"{interpreter}-{abi}-{platform}" for interpreter in interpreters for abi in abis]
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder) / "wheel"
        copy_tree(arguments.tree, root / "retarget")
        copy_python(arguments.modules, root / "retarget")
        write_metadata(root / f"retarget-{version()}.dist-info", tags)
        arguments.output.mkdir(parents=True, exist_ok=True)
        subprocess.run([sys.executable, "-m", "wheel", "pack", root, "-d", arguments.output], check=True)


if __name__ == "__main__":
    main()
