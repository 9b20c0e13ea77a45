"""Reads what torch.save writes, without PyTorch and by its own rules alone: an archive, a pickle
whose tensors refer to storages beside it. Nothing but tensors and named values is made."""

import pathlib
import pickle
import zipfile
from typing import Any

import numpy as np

STORAGES = {"FloatStorage": "<f4", "DoubleStorage": "<f8", "LongStorage": "<i8",
            "BoolStorage": "|b1"}


class TorchUnpickler(pickle.Unpickler):
    """Makes NumPy arrays of tensors, and pairs of class name and value of enumerations."""

    def __init__(self, archive: zipfile.ZipFile, folder: str) -> None:
        super().__init__(archive.open(f"{folder}/data.pkl"))
        self.archive, self.folder = archive, folder

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) == ("torch._utils", "_rebuild_tensor_v2"):
            return rebuild
        if (module, name) == ("collections", "OrderedDict"):
            return dict
        if module == "torch" and name in STORAGES:
            return np.dtype(STORAGES[name])
        if name == "StateConversion":
            return lambda value: (f"{module}.{name}", value)
        raise pickle.UnpicklingError(f"{module}.{name}")

    def persistent_load(self, pid: tuple) -> np.ndarray:
        kind, dtype, key, device, count = pid
        assert (kind, device) == ("storage", "cpu")
        storage = np.frombuffer(self.archive.read(f"{self.folder}/data/{key}"), dtype)
        assert len(storage) == count
        return storage


def rebuild(storage: np.ndarray, offset: int, size: tuple, stride: tuple, requires_grad: bool,
            hooks: dict) -> np.ndarray:
    """Returns a tensor as a view of a storage; offset and stride in elements."""
    assert not requires_grad and not hooks
    steps = [step * storage.itemsize for step in stride]
    return np.lib.stride_tricks.as_strided(storage[offset:], size, steps).copy()


def load(path: pathlib.Path) -> dict[str, Any]:
    """Returns the dictionary in a file; checks the checksum of every entry."""
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        folders = {name.split("/")[0] for name in archive.namelist()}
        assert len(folders) == 1
        folder = folders.pop()
        assert archive.read(f"{folder}/byteorder") == b"little"
        assert archive.read(f"{folder}/version").strip() == b"3"
        return TorchUnpickler(archive, folder).load()
