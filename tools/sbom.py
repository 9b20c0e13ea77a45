"""Prints the parts of a release for Linux as a CycloneDX document: sbom.py ARCH

Names, versions and licences come from the files that pin and describe them: tools/release_sources.txt, mujoco.txt, zig.txt
and python.txt, the installed packages of header-only libraries, viewer/package-lock.json, the profiles of the robots, and
THIRD_PARTY_NOTICES. A part that has no notice is an error. The document is checked against the schema of CycloneDX 1.6.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import uuid
from datetime import datetime, timezone
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent
# Debian's package of each header-only library.
HEADERS = {"Eigen": "libeigen3-dev", "nlohmann-json": "nlohmann-json3-dev", "fmt": "libfmt-dev",
           "tl-expected": "libexpected-dev", "CLI11": "libcli11-dev"}
# The name in THIRD_PARTY_NOTICES of each Debian source package of tools/release_sources.txt.
SOURCES = {"zlib": "zlib", "tinyxml2": "tinyxml2", "libzip": "libzip", "lz4": "LZ4", "zeromq3": "ZeroMQ",
           "hiredis": "hiredis"}
LLVM = "LLVM's libc++, libc++abi, libunwind and compiler-rt"


def text(path: str) -> str:
    return (SOURCE / path).read_text(encoding="utf-8")


def notices() -> dict[str, str]:
    """Returns the licence of each part by its name in THIRD_PARTY_NOTICES."""
    return dict(re.findall(r"^={78}\n(.*)\n\nLicence: (.*)", text("THIRD_PARTY_NOTICES"), re.MULTILINE))


def component(name: str, version: str, where: str, hashes: list[str] = (), kind: str = "library") -> dict:
    licences = notices()
    if name not in licences:
        sys.exit(f"sbom: THIRD_PARTY_NOTICES does not mention {name}")
    part = {"type": kind, "bom-ref": f"{name}@{version}", "name": name, "version": version,
            "licenses": [{"license": {"name": licences[name]}}],
            "properties": [{"name": "retarget:origin", "value": where}]}
    if hashes:
        # Hashes of the archives or wheels that the pinned list names.
        part["hashes"] = [{"alg": "SHA-256", "content": content} for content in hashes]
    return part


def pinned_wheel(file: str, package: str) -> tuple[str, list[str]]:
    found = re.search(rf"^{package}==(\S+)((?:.*\\\n)(?:.*--hash.*\n?)+)", text(file), re.MULTILINE)
    return found[1], re.findall(r"sha256:([0-9a-f]{64})", found[2])


def debian_sources() -> list[dict]:
    rows = [line.split() for line in text("tools/release_sources.txt").splitlines() if not line.startswith("#")]
    parts = []
    for package, name in SOURCES.items():
        files = [(file, digest) for row, file, digest in rows if row == package]
        version = re.search(r"_([0-9.]+?)(?:[.+]dfsg)?\.orig\.", files[0][0])[1]
        parts.append(component(name, version, f"Debian source package {package}", [digest for _, digest in files]))
    return parts


def header_libraries() -> list[dict]:
    parts = []
    for name, package in HEADERS.items():
        version = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", package], check=True, text=True,
                                 stdout=subprocess.PIPE).stdout
        parts.append(component(name, version, f"Debian package {package}, headers only"))
    return parts


def other_parts() -> list[dict]:
    mujoco, mujoco_hashes = pinned_wheel("tools/mujoco.txt", "mujoco-core")
    zig, zig_hashes = pinned_wheel("tools/zig.txt", "ziglang")
    nanobind, nanobind_hashes = pinned_wheel("tools/python.txt", "nanobind")
    three = json.loads(text("viewer/package-lock.json"))["packages"]["node_modules/three"]["version"]
    ufbx = re.search(r"\b(\d+\.\d+\.\d+)\b", text("third_party/ufbx/README.md"))[1]
    return [component("MuJoCo", mujoco, "wheel mujoco-core, shared library", mujoco_hashes),
            component(LLVM, zig, "wheel ziglang", zig_hashes),
            component("nanobind", nanobind, "wheel nanobind, in the Python module", nanobind_hashes),
            component("robin-map", nanobind, "in the wheel nanobind"),
            component("three.js", three, "npm, in the script of pages"),
            component("ufbx", ufbx, "third_party/ufbx")]


def robots() -> list[dict]:
    parts = []
    for file in sorted((SOURCE / "robots").glob("*/robot.json")):
        profile = json.loads(file.read_text(encoding="utf-8"))
        parts.append({"type": "data", "bom-ref": f"robot:{file.parent.name}", "name": file.parent.name,
                      "licenses": [{"license": {"name": profile["licence"]}}]})
    return parts


def document(arch: str) -> dict:
    version = re.search(r"project\(retarget VERSION ([0-9.]+)", text("CMakeLists.txt"))[1]
    epoch = int(os.environ["SOURCE_DATE_EPOCH"])
    parts = sorted(debian_sources() + header_libraries() + other_parts(), key=lambda part: part["name"].lower())
    own = f"retarget@{version}"
    # The same release has the same number.
    number = uuid.uuid5(uuid.NAMESPACE_URL, f"retarget {version} linux {arch} {epoch} {json.dumps(parts)}")
    return {"bomFormat": "CycloneDX", "specVersion": "1.6", "serialNumber": f"urn:uuid:{number}", "version": 1,
            "metadata": {"timestamp": datetime.fromtimestamp(epoch, timezone.utc).isoformat(),
                         "component": {"type": "application", "bom-ref": own, "name": "retarget", "version": version,
                                       "licenses": [{"license": {"id": "Apache-2.0"}}],
                                       "properties": [{"name": "retarget:system", "value": f"linux-{arch}"}]}},
            "components": parts + robots(),
            "dependencies": [{"ref": own, "dependsOn": [part["bom-ref"] for part in parts]}]}


def check(content: str) -> None:
    from cyclonedx.schema import SchemaVersion
    from cyclonedx.validation.json import JsonStrictValidator
    fault = JsonStrictValidator(SchemaVersion.V1_6).validate_str(content)
    if fault is not None:
        sys.exit(f"sbom: the document does not follow the schema: {fault}")


def main() -> None:
    content = json.dumps(document(sys.argv[1]), indent=2) + "\n"
    check(content)
    sys.stdout.write(content)


if __name__ == "__main__":
    main()
