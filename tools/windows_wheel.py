#!/usr/bin/env python3
"""Makes a Python wheel for Windows of an unpacked package: pip installs the command, without a module.

    windows_wheel.py PACKAGE OUTPUT_FOLDER

PACKAGE is the folder in the .zip that tools/windows.sh makes. The program, MuJoCo's DLL beside it and share/ go where
pip puts scripts and data, in which the program finds its robots as in PACKAGE. The same PACKAGE gives the same bytes."""

import base64
import hashlib
import pathlib
import re
import sys
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
TAG = "py3-none-win_amd64"
DATE = (1980, 1, 1, 0, 0, 0)  # Date of every file.


def setting(name):
    """A text of pyproject.toml (Python 3.10 has no reader of TOML)."""
    return re.search(rf'^{name} = "(.*)"$', (ROOT / "pyproject.toml").read_text(), re.M).group(1)


def main():
    package, output = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    version = re.search(r"project\(retarget VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
    name = f"retarget-{version}"
    files = {}
    for file in sorted(each for each in package.rglob("*") if each.is_file()):
        path = file.relative_to(package)
        scheme = "scripts" if path.parts[0] == "bin" else "data"
        inside = path.relative_to("bin") if scheme == "scripts" else path
        files[f"{name}.data/{scheme}/{inside.as_posix()}"] = file.read_bytes()
    info = f"{name}.dist-info"
    for licence in ("LICENSE", "THIRD_PARTY_NOTICES"):
        files[f"{info}/licenses/{licence}"] = (ROOT / licence).read_bytes()
    files[f"{info}/METADATA"] = "\n".join([
        "Metadata-Version: 2.1", "Name: retarget", f"Version: {version}", f"Summary: {setting('description')}",
        f"License: {setting('license')}", "Classifier: Operating System :: Microsoft :: Windows",
        "Description-Content-Type: text/markdown", "",
        "This wheel has the command `retarget` for Windows, but no Python module.", ""]).encode()
    files[f"{info}/WHEEL"] = (f"Wheel-Version: 1.0\nGenerator: retarget\nRoot-Is-Purelib: false\nTag: {TAG}\n").encode()
    record = ""
    for path, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
        quoted = f'"{path}"' if "," in path else path
        record += f"{quoted},sha256={digest},{len(content)}\n"
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    wheel = output / f"{name}-{TAG}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, content in files.items():
            archive.writestr(zipfile.ZipInfo(path, DATE), content, zipfile.ZIP_DEFLATED)
    print(wheel)


if __name__ == "__main__":
    sys.exit(main())
