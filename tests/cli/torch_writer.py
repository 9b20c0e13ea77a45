"""Writes what torch.save writes, without PyTorch: an archive with a pickle of protocol 2, whose
tensors refer to storages beside it."""

import io
import struct
import zipfile
from typing import Any

import numpy

STORAGES = {"f8": "DoubleStorage", "f4": "FloatStorage", "f2": "HalfStorage", "i8": "LongStorage",
            "i4": "IntStorage", "u1": "ByteStorage", "b1": "BoolStorage"}


def named(module: str, name: str) -> bytes:
    """Opcodes that name a function or class."""
    return f"c{module}\n{name}\n".encode()


def sequence(*parts: bytes) -> bytes:
    """Opcodes of a tuple."""
    return b"(" + b"".join(parts) + b"t"


class TorchPickle:
    """Values as opcodes, and the storages that they refer to."""

    def __init__(self) -> None:
        self.storages: list[bytes] = []

    def value(self, value: Any) -> bytes:
        """Opcodes of a dictionary, list, text, number, None or array (a tensor of its layout)."""
        if isinstance(value, bytes):  # opcodes already
            return value
        if isinstance(value, numpy.ndarray):
            return self.tensor(value)
        if isinstance(value, dict):
            return b"}(" + b"".join(map(self.value, sum(value.items(), ()))) + b"u"
        if isinstance(value, list):
            return b"](" + b"".join(map(self.value, value)) + b"e"
        if isinstance(value, str):
            return b"X" + struct.pack("<I", len(value.encode())) + value.encode()
        if isinstance(value, float):
            return b"G" + struct.pack(">d", value)
        return b"N" if value is None else b"\x8a\x08" + struct.pack("<q", int(value))

    def tensor(self, array: numpy.ndarray) -> bytes:
        """A tensor; views of an array that is a storage in C order share it and stay views."""
        base = array if array.base is None else array.base
        if not base.flags.c_contiguous:
            base = array = numpy.ascontiguousarray(array)
        name = named("torch", STORAGES[array.dtype.str[1:]])
        storage = sequence(self.value("storage"), name, self.value(str(len(self.storages))),
                           self.value("cpu"), self.value(base.size)) + b"Q"
        self.storages.append(base.tobytes())
        start = (array.__array_interface__["data"][0] - base.__array_interface__["data"][0])
        layout = (sequence(*map(self.value, array.shape)),
                  sequence(*(self.value(step // array.itemsize) for step in array.strides)))
        return (named("torch._utils", "_rebuild_tensor_v2") +
                sequence(storage, self.value(start // array.itemsize), *layout, b"\x89",
                         named("collections", "OrderedDict") + b")R") + b"R")


def torch_bytes(value: Any, compress: bool = False) -> bytes:
    """Returns the file that torch.save would write; bytes in the value are opcodes."""
    made = TorchPickle()
    return archive_of(b"\x80\x02" + made.value(value) + b".", made.storages, compress)


def archive_of(pickled: bytes, storages: list[bytes], compress: bool = False) -> bytes:
    """A pickle and its storages."""
    packed = io.BytesIO()
    kind = zipfile.ZIP_DEFLATED if compress else zipfile.ZIP_STORED
    with zipfile.ZipFile(packed, "w", kind) as archive:
        archive.writestr(zipfile.ZipInfo("motion/data.pkl"), pickled, kind)
        archive.writestr(zipfile.ZipInfo("motion/byteorder"), "little", kind)
        for key, numbers in enumerate(storages):
            archive.writestr(zipfile.ZipInfo(f"motion/data/{key}"), numbers, kind)
        archive.writestr(zipfile.ZipInfo("motion/version"), "3\n", kind)
    return packed.getvalue()
