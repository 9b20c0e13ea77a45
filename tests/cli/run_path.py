"""The library search paths of an ELF file, and which of them are not fixed folders."""

import struct

DT_NULL, DT_STRTAB, DT_RPATH, DT_RUNPATH = 0, 5, 15, 29
PT_LOAD, PT_DYNAMIC = 1, 2


def run_path(path):
    """RPATH and RUNPATH of a 64-bit little-endian ELF file; None: it has neither."""
    data = path.read_bytes()
    if data[:6] != b"\x7fELF\x02\x01":
        raise ValueError(f"{path} is no 64-bit little-endian ELF file")
    table, = struct.unpack_from("<Q", data, 32)
    size, count = struct.unpack_from("<HH", data, 54)
    loads, dynamic = [], None
    for at in range(table, table + size * count, size):
        kind, _, offset, address, _, length = struct.unpack_from("<IIQQQQ", data, at)
        if kind == PT_LOAD:
            loads.append((address, offset, length))
        if kind == PT_DYNAMIC:
            dynamic = (offset, length)
    if dynamic is None:
        return None
    entries = []
    for at in range(dynamic[0], sum(dynamic), 16):
        tag, value = struct.unpack_from("<qQ", data, at)
        if tag == DT_NULL:
            break
        entries.append((tag, value))
    texts = next(value for tag, value in entries if tag == DT_STRTAB)
    start = next(offset + texts - address for address, offset, length in loads
                 if address <= texts < address + length)
    found = [data[start + value:data.index(b"\0", start + value)].decode()
             for tag, value in entries if tag in (DT_RPATH, DT_RUNPATH)]
    return ":".join(found) if found else None


def loose_entries(path):
    """Entries of the run path that depend on the working directory: empty and relative ones."""
    text = run_path(path)
    if text is None:
        return []
    return [entry for entry in text.split(":")
            if not entry.startswith(("/", "$ORIGIN", "${ORIGIN}"))]
