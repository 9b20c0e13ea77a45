#!/usr/bin/env python3
"""Makes the browser page from the engine, the robots and the sources in browser/page (docs/browser.md).

    browser/make_page.py --engine retarget.wasm --tool retarget --output FOLDER

FOLDER receives retarget.html, which holds everything and loads nothing, and for tests data.bundle. Equal inputs give
equal bytes. --tool is a native retarget, which packs the robots' models.
"""

import argparse
import base64
import gzip
import hashlib
import json
import pathlib
import re
import struct
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "browser" / "page"
# A robot's folder needs a model; its content comes from the pack.
MODEL_NOTE = b"<!-- The compiled model is in models.pack. -->\n"


def robot_files(tool, name):
    """The files of a robot in the page's data folder."""
    folder = ROOT / "robots" / name
    files = {}
    for path in sorted(folder.glob("*")):
        files[path.name] = MODEL_NOTE if path.suffix == ".xml" else path.read_bytes()
    pack = subprocess.run([tool, "generate", "robot-pack", name], check=True, stdout=subprocess.PIPE)
    files["models.pack"] = pack.stdout
    return {f"data/robots/{name}/{key}": value for key, value in files.items()}


def data_files(tool):
    """All files of the page's data folder: the robots whose licences permit distribution, and configs/."""
    index = ROOT / "robots" / "index.json"
    files = {"data/robots/index.json": index.read_bytes()}
    names = sorted(path.parent.name for path in (ROOT / "robots").glob("*/model.xml"))
    for name in names:
        files |= robot_files(tool, name)
    for path in sorted((ROOT / "configs").rglob("*.json")):
        files["data/" + path.relative_to(ROOT).as_posix()] = path.read_bytes()
    return files


def licences(toolchain):
    """The licences of all that the page contains, as one text."""
    wheel = toolchain / "wheel" / "ziglang" / "lib"
    parts = [(ROOT / "LICENSE").read_text(), (ROOT / "THIRD_PARTY_NOTICES").read_text()]
    for title, path in [("C library (musl)", wheel / "libc" / "musl" / "COPYRIGHT"),
                        ("WASI's C library", wheel / "libc" / "wasi" / "LICENSE"),
                        ("C++ library (libc++)", wheel / "libcxx" / "LICENSE.TXT")]:
        parts.append(f"{title}\n\n{path.read_text()}")
    rule = "\n" + 80 * "-" + "\n\n"
    return rule.join(parts).encode()


def bundle(files):
    """Packs files as browser/page/bundle.js reads them."""
    index = json.dumps([[path, len(content)] for path, content in files.items()]).encode()
    return struct.pack("<I", len(index)) + index + b"".join(files.values())


def packed(content):
    """Bytes as Base64 of gzip, for a script element."""
    return base64.b64encode(gzip.compress(content, 9, mtime=0)).decode()


def script(*names):
    """Modules joined to one script."""
    text = "".join((PAGE / name).read_text() for name in names)
    text = re.sub(r"^import .*\n", "", text, flags=re.M)
    return "\n" + re.sub(r"^export ", "", text, flags=re.M)


def source_hash(text):
    """A source of a content security policy: the hash of an inline script or style."""
    return "'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'"


def make_page(engine, data):
    """The whole page."""
    viewer_script = (ROOT / "viewer" / "dist" / "viewer.js").read_text()
    viewer_style = (ROOT / "viewer" / "page.css").read_text()
    main, worker = script("contacts.js", "form.js", "app.js"), script("wasi.js", "bundle.js", "worker.js")
    style = "\n" + (PAGE / "page.css").read_text()
    # The frame with the viewer inherits the policy.
    policy = "; ".join([
        "default-src 'none'",
        f"script-src {source_hash(main)} {source_hash(viewer_script)} 'wasm-unsafe-eval'",
        f"style-src {source_hash(style)} {source_hash(viewer_style)}",
        "worker-src blob:", "base-uri 'none'", "form-action 'none'",
    ])
    assert "</script" not in worker
    shell = (PAGE / "page.html").read_text()
    for mark, text in [("@POLICY@", policy), ("@STYLE@", style), ("@WORKER@", worker), ("@ENGINE@", packed(engine)),
                       ("@DATA@", packed(data)), ("@SCRIPT@", main)]:
        assert shell.count(mark) == 1, mark
        shell = shell.replace(mark, text)
    return shell


def main():
    """Reads the arguments and writes the files."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--engine", type=pathlib.Path, required=True)
    parser.add_argument("--tool", required=True)
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--toolchain", type=pathlib.Path, default=ROOT / "build" / "deps" / "wasm")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    files = data_files(arguments.tool)
    files["out/licences.txt"] = licences(arguments.toolchain)
    data = bundle(files)
    (arguments.output / "data.bundle").write_bytes(data)
    page = make_page(arguments.engine.read_bytes(), data)
    (arguments.output / "retarget.html").write_text(page)
    print(f"{arguments.output / 'retarget.html'}: {len(page) / 1e6:.2f} MB, gzip "
          f"{len(gzip.compress(page.encode(), 9)) / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
