#!/usr/bin/env python3
"""Makes the pictures of docs/viewing.md from data/: pages of the samples, opened in Chromium.

    tools/viewing_pictures.py TOOL      for example build/release/tools/retarget/retarget

tools/docs_figures.py also calls this script if the values on the pages have changed.

Needs numpy and Chromium (tools/setup.sh). Pictures are PNG files with a palette, each below 150 kB.
"""

import base64
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

import numpy as np

SOURCE = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(SOURCE / "tests/cli"))
import browser  # noqa: E402  (of the tests)
from pictures import SIGNATURE, chunk  # noqa: E402

MAX_BYTES = 150_000
# Name: page, time, window size, media features, scripts that prepare the view.
SCENES = {
    "view_compare": ("two.html", "#t=3.6", (1280, 720), {}, []),
    "view_faults": (
        "gmr.html",
        "#t=0",
        (1280, 720),
        {},
        [
            "document.getElementById('tab-faults').click()",
            "document.querySelectorAll('.list button')[3].click()",
        ],
    ),
    "view_joints": (
        "get_up.html",
        "#t=4.2",
        (1280, 720),
        {"prefers-color-scheme": "dark"},
        ["document.getElementById('tab-joints').click()"],
    ),
}


def make_pages(tool, folder):
    """Makes motions of two samples, and their pages."""

    def run(*arguments):
        subprocess.run([tool, *map(str, arguments)], cwd=folder, check=True)

    walk, get_up = (SOURCE / "data" / f"{name}.bvh" for name in ("walk", "get_up"))
    run(walk, "unitree_g1", "-o", "fit.csv", "-q")
    run(walk, "unitree_g1", "--method", "gmr", "-o", "gmr.csv", "-q")
    run(get_up, "unitree_g1", "-o", "get_up.csv", "-q")
    run(get_up, "unitree_g1", "--method", "gmr", "-o", "get_up_gmr.csv", "-q")
    view = ("--robot", "unitree_g1", "-q", "-o")
    run("view", "fit.csv", "gmr.csv", "--bvh", walk, *view, "two.html")
    run("view", "get_up_gmr.csv", "--bvh", get_up, *view, "gmr.html")
    run("view", "get_up.csv", "--bvh", get_up, *view, "get_up.html")


def pixels_of(window, png):
    """Returns the pixels (height, width, 3) of a PNG, decoded by the browser."""
    window.open("/dev/null")
    width, height, rgba = window.run(f"""(async () => {{
        const text64 = '{base64.b64encode(png).decode()}';
        const bytes = Uint8Array.from(atob(text64), (c) => c.charCodeAt(0));
        const image = await createImageBitmap(new Blob([bytes]));
        const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
        context.drawImage(image, 0, 0);
        const {{ data }} = context.getImageData(0, 0, image.width, image.height);
        let text = '';
        for (let i = 0; i < data.length; i += 8192) {{
            text += String.fromCharCode(...data.subarray(i, i + 8192));
        }}
        return [image.width, image.height, btoa(text)];
    }})()""")
    return np.frombuffer(base64.b64decode(rgba), np.uint8).reshape(height, width, 4)[:, :, :3]


def palette_of(pixels, most=256):
    """Returns colours (most, 3) by median cut, and the colour index of each pixel (height, width)."""
    colours, inverse, counts = np.unique(
        pixels.reshape(-1, 3), axis=0, return_inverse=True, return_counts=True
    )
    boxes = [np.arange(len(colours))]
    while len(boxes) < most:
        # Split the box with the widest spread, weighted by its share of the pixels.
        spreads = [
            (
                np.ptp(colours[box].astype(float), axis=0).max() * counts[box].sum() ** 0.4
                if len(box) > 1
                else 0.0
            )
            for box in boxes
        ]
        widest = int(np.argmax(spreads))
        if spreads[widest] == 0.0:
            break
        box = boxes.pop(widest)
        axis = int(np.argmax(np.ptp(colours[box].astype(float), axis=0)))
        box = box[np.argsort(colours[box][:, axis], kind="stable")]
        half = int(np.searchsorted(np.cumsum(counts[box]), counts[box].sum() / 2))
        half = min(max(half, 1), len(box) - 1)
        boxes += [box[:half], box[half:]]
    palette = np.zeros((len(boxes), 3), np.uint8)
    index = np.zeros(len(colours), np.uint8)
    for i, box in enumerate(boxes):
        palette[i] = np.average(colours[box], axis=0, weights=counts[box]).round()
        index[box] = i
    return palette, index[inverse.reshape(-1)].reshape(pixels.shape[:2])


def palette_png(pixels):
    """Returns the bytes of a PNG with a palette of 256 colours."""
    palette, index = palette_of(pixels)
    height, width = index.shape
    rows = b"".join(b"\0" + row.tobytes() for row in index)
    return (
        SIGNATURE
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0))
        + chunk(b"PLTE", palette.tobytes())
        + chunk(b"IDAT", zlib.compress(rows, 9))
        + chunk(b"IEND", b"")
    )


def take_pictures(folder):
    """Takes screenshots of the pages in a folder."""
    with browser.Browser(browser.chromium()) as window:
        for name, (page, moment, size, features, scripts) in SCENES.items():
            window.open(pathlib.Path(folder) / page, moment, size=size, features=features)
            window.wait_for("window.retarget")
            for script in [
                *scripts,
                "new Promise((done) => setTimeout(done, 600))",
                "retarget.picture() && 0",
            ]:
                window.run(script)
            png = palette_png(pixels_of(window, window.screenshot()))
            if len(png) > MAX_BYTES:
                sys.exit(f"viewing_pictures: {name} takes {len(png)} bytes")
            (SOURCE / "docs/pictures" / f"{name}.png").write_bytes(png)


def main():
    """Makes all pictures."""
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    if not browser.chromium():
        sys.exit("viewing_pictures: there is no Chromium (Debian: chromium)")
    with tempfile.TemporaryDirectory() as folder:
        make_pages(pathlib.Path(sys.argv[1]).resolve(), folder)
        take_pictures(folder)


if __name__ == "__main__":
    main()
