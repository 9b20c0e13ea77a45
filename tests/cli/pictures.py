"""PNG read and written with zlib and numpy alone, and pictures compared coarsely."""

import struct
import zlib

import numpy as np

SIGNATURE = b"\x89PNG\r\n\x1a\n"


def read_png(data):
    """Pixels (height, width, 3) of a PNG as write_png makes them: 8 bits, RGB, no filters."""
    assert data.startswith(SIGNATURE)
    at, packed = len(SIGNATURE), b""
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        content = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", content)
            assert depth == 8 and colour == 2 and not interlaced
        elif kind == b"IDAT":
            packed += content
        at += length + 12
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + 3 * width)
    assert not rows[:, 0].any()
    return rows[:, 1:].reshape(height, width, 3)


def chunk(kind, content):
    """A chunk of a PNG, bytes."""
    return (
        struct.pack(">I", len(content))
        + kind
        + content
        + struct.pack(">I", zlib.crc32(kind + content))
    )


def write_png(pixels):
    """A PNG of pixels (height, width, 3), bytes."""
    height, width, _ = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels.astype(np.uint8))
    return (
        SIGNATURE
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(rows, 9))
        + chunk(b"IEND", b"")
    )


def coarse(pixels, side=8):
    """Averages a picture over blocks of side x side pixels; drops incomplete blocks."""
    height, width = (length - length % side for length in pixels.shape[:2])
    blocks = (
        pixels[:height, :width].astype(float).reshape(height // side, side, width // side, side, 3)
    )
    return blocks.mean(axis=(1, 3)).round().astype(np.uint8)


def differences(found, expected):
    """Mean difference of two pictures of one size, and the share of pixels over 24 of 255 apart."""
    apart = np.abs(found.astype(int) - expected.astype(int)).max(axis=2)
    return float(apart.mean()), float((apart > 24).mean())
