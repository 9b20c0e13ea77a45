"""Support for tests of pages."""

import base64
import json
import re
import zlib

import numpy as np


def data_of(page):
    """(header, length of its text, length of the packed numbers) of a page's text."""
    header = re.search(r'id="page-header">(.*?)</script>', page, re.DOTALL)[1]
    tracks = re.search(r'id="page-tracks">(.*?)</script>', page, re.DOTALL)[1]
    return json.loads(zlib.decompress(base64.b64decode(header))), len(header), len(tracks)


def tracks_of(page):
    """The packed numbers per track of the page's header, in order: (frames, channels)."""
    header = data_of(page)[0]
    text = re.search(r'id="page-tracks">(.*?)</script>', page, re.DOTALL)[1]
    packed = np.frombuffer(zlib.decompress(base64.b64decode(text)), np.uint8)
    tracks = []
    for track in header["tracks"]:
        channels, frames = track["channels"], track["frames"]
        orders, packed = packed[:channels], packed[channels:]
        planes, packed = packed[: 4 * channels * frames], packed[4 * channels * frames :]
        planes = planes.reshape(4, channels, frames).astype(np.uint32)
        folded = sum(planes[i] << np.uint32(8 * i) for i in range(4))
        values = (folded >> np.uint32(1)) ^ (np.uint32(0) - (folded & np.uint32(1)))
        for channel, order in zip(values, orders):
            for _ in range(order):
                channel[:] = np.cumsum(channel, dtype=np.uint32)
        tracks.append(values.view(np.int32).T * track["step"])
    return tracks
