"""Writes NPZ files with NumPy into a folder, and expected.json with what is in them.

    write_npz.py FOLDER

Exit code 77: there is no NumPy.
"""

import io
import json
import pathlib
import sys
import warnings
import zipfile

try:
    import numpy as np
except ImportError:
    sys.exit(77)

NUMBERS = {
    "b1": [True, False, True, True, False, False],
    "i1": [-128, -1, 0, 1, 2, 127],
    "i2": [-32768, -1, 0, 1, 258, 32767],
    "i4": [-(2**31), -1, 0, 1, 16909060, 2**31 - 1],
    "i8": [-(2**53), -1, 0, 1, 2**33 + 1, 2**53],
    "u1": [0, 1, 2, 127, 128, 255],
    "u2": [0, 1, 258, 32768, 40000, 65535],
    "u4": [0, 1, 16909060, 2**31, 3 * 10**9, 2**32 - 1],
    "u8": [0, 1, 2**33 + 1, 2**53, 2**63, 2**40],
    "f2": [0.0, -1.5, 65504.0, 6e-8, 1 / 3, -0.0999],
    "f4": [0.0, -1.5, 3.4e38, 1e-45, 1 / 3, -0.1],
    "f8": [0.0, -1.5, 1.7e308, 5e-324, 1 / 3, -0.1],
}
TEXTS = ["male", "", "b\u00e9b\u00e9", "\u20ac", "\U0001f600 x", "neutral"]


def plain_arrays():
    """name: array, of every type, order and kind of shape."""
    arrays = {}
    for code, values in NUMBERS.items():
        for order in "<>":
            array = np.array(values).astype(order + code)
            arrays[f"{code}_{'little' if order == '<' else 'big'}"] = array
        arrays[f"{code}_fortran"] = np.asfortranarray(np.array(values).astype(code).reshape(2, 3))
        arrays[f"{code}_scalar"] = np.array(values[1]).astype(code)
        arrays[f"{code}_empty"] = np.zeros((0, 3), code)
    arrays["text_little"] = np.array(TEXTS)
    arrays["text_big"] = np.array(TEXTS).astype(">U9").reshape(3, 2)
    arrays["text_scalar"] = np.array("neutral")
    arrays["text_fortran"] = np.asfortranarray(np.array(TEXTS).reshape(2, 3))
    arrays["bytes"] = np.array([b"male", b"", b"female"])
    arrays["bytes_scalar"] = np.bytes_("male")
    arrays["text_empty"] = np.array("")
    arrays["deep"] = np.asfortranarray(np.arange(2 * 3 * 4 * 5).reshape(2, 3, 4, 5) / 7)
    arrays["strided"] = np.arange(40.0).reshape(5, 8)[::2, 1::3]
    random = np.random.default_rng(5)
    arrays["long"] = random.normal(size=(3000, 24)).astype("f4")
    arrays["name with blank"] = np.arange(3)
    return arrays


def content(array):
    array = np.asarray(array)
    found = {"shape": list(array.shape)}
    flat = array.flatten(order="C")
    if array.dtype.kind == "U":
        found["texts"] = [str(text) for text in flat]
    elif array.dtype.kind == "S":
        found["texts"] = [text.decode() for text in flat]
    else:
        found["numbers"] = [float(value) for value in flat]
    return found


def refused_arrays():
    """name: (array, word of the error)"""
    objects = np.empty((), object)
    objects[()] = b"male"
    return {
        "objects": (objects, "Python objects"),
        "ragged": (np.array([None, {"a": 1}], object), "Python objects"),
        "complex": (np.array([1j]), "not supported"),
        "long_double": (np.array([1], np.longdouble), "not supported"),
        "date": (np.array(["2020-01-01"], "M8[D]"), "not supported"),
        "record": (np.zeros(2, [("x", "f4"), ("y", "i4", (2,))]), "not supported"),
    }


def npy_bytes(array, version):
    stream = io.BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        np.lib.format.write_array(stream, np.asanyarray(array), version=version)
    return stream.getvalue()


class Unseekable(io.RawIOBase):
    """A pipe: zipfile writes data descriptors to it."""

    def __init__(self):
        super().__init__()
        self.bytes = b""

    def writable(self):
        return True

    def write(self, data):
        self.bytes += bytes(data)
        return len(data)


def main():
    folder = pathlib.Path(sys.argv[1])
    arrays = plain_arrays()
    expected = {}

    def holds(file, some):
        expected[file] = {"arrays": {name: content(array) for name, array in some.items()}}

    np.savez(folder / "stored.npz", **arrays)
    holds("stored.npz", arrays)
    np.savez_compressed(folder / "deflated.npz", **arrays)
    holds("deflated.npz", arrays)
    np.savez(folder / "nothing.npz")
    holds("nothing.npz", {})

    small = {"poses": np.arange(6.0).reshape(2, 3), "gender": np.array("male")}
    for name, version in {"v1": (1, 0), "v2": (2, 0), "v3": (3, 0)}.items():
        with zipfile.ZipFile(folder / f"{name}.npz", "w") as archive:
            for key, array in small.items():
                archive.writestr(key + ".npy", npy_bytes(array, version))
        holds(f"{name}.npz", small)

    pipe = Unseekable()
    with zipfile.ZipFile(pipe, "w", zipfile.ZIP_DEFLATED) as archive:
        for key, array in small.items():
            archive.writestr(key + ".npy", npy_bytes(array, (1, 0)))
    (folder / "streamed.npz").write_bytes(pipe.bytes)
    holds("streamed.npz", small)

    refused = refused_arrays()
    np.savez(folder / "refused.npz", allowed=np.arange(3), **{k: v[0] for k, v in refused.items()})
    holds("refused.npz", {"allowed": np.arange(3)})
    expected["refused.npz"]["refused"] = {name: word for name, (_, word) in refused.items()}

    for name, method in {"bzip2": zipfile.ZIP_BZIP2, "lzma": zipfile.ZIP_LZMA}.items():
        with zipfile.ZipFile(folder / f"{name}.npz", "w", method) as archive:
            archive.writestr("a.npy", npy_bytes(np.arange(3), (1, 0)))
        expected[f"{name}.npz"] = {"arrays": {}, "refused": {"a": "compression"}}

    # The header claims more data than the archive contains; the archive is otherwise valid.
    claim = npy_bytes(np.zeros(8), (1, 0))
    claim = claim.replace(b"(8,), }" + b" " * 12, b"(8000000000000,), }")
    for name, method in {"claim": zipfile.ZIP_STORED, "claim_z": zipfile.ZIP_DEFLATED}.items():
        with zipfile.ZipFile(folder / f"{name}.npz", "w", method) as archive:
            archive.writestr("a.npy", claim)
        expected[f"{name}.npz"] = {"arrays": {}, "refused": {"a": "needs 64000000000000 bytes"}}

    (folder / "expected.json").write_text(json.dumps(expected))


if __name__ == "__main__":
    main()
