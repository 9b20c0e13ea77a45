"""What the tests of pages share."""

import base64
import json
import re
import zlib


def data_of(page):
    """(header, length of its text, length of the packed numbers) of a page's text."""
    header = re.search(r'id="page-header">(.*?)</script>', page, re.DOTALL)[1]
    tracks = re.search(r'id="page-tracks">(.*?)</script>', page, re.DOTALL)[1]
    return json.loads(zlib.decompress(base64.b64decode(header))), len(header), len(tracks)
