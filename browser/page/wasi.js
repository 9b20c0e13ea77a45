// The part of WASI (preview 1) that the engine uses, over files in memory. Files below /out may be
// written; all others are read-only.

const ERRNO = { success: 0, acces: 2, badf: 8, exist: 20, inval: 28, isdir: 31, noent: 44, nosys: 52, notdir: 54, rofs: 69 };
const TYPE = { unknown: 0, character: 2, directory: 3, file: 4 };
const ROOT = 3;  // the first descriptor after the standard streams: the root folder

class ExitError extends Error {
  constructor(code) {
    super(`exit ${code}`);
    this.code = code;
  }
}

// Joins a path that is relative to a folder: no leading slash, no `.` or `..`.
function joined(folder, path) {
  const parts = [];
  for (const part of `${folder}/${path}`.split("/")) {
    if (part === "" || part === ".") continue;
    if (part === "..") parts.pop();
    else parts.push(part);
  }
  return parts.join("/");
}

// Files by path, without leading slash: Uint8Array.
export class MemoryFiles {
  constructor(files) {
    this.files = new Map(files);
    this.folders = new Set(["", "out"]);
    for (const path of this.files.keys()) this.addFolders(path);
  }

  addFolders(path) {
    const parts = path.split("/");
    for (let i = 1; i < parts.length; i++) this.folders.add(parts.slice(0, i).join("/"));
  }

  // Names in a folder, sorted, with their types.
  list(folder) {
    const begin = folder === "" ? "" : `${folder}/`;
    const names = new Map();
    for (const path of this.files.keys()) {
      if (path.startsWith(begin) && !path.slice(begin.length).includes("/")) {
        names.set(path.slice(begin.length), TYPE.file);
      }
    }
    for (const path of this.folders) {
      const rest = path.slice(begin.length);
      if (path.startsWith(begin) && rest !== "" && !rest.includes("/")) names.set(rest, TYPE.directory);
    }
    return [...names].sort((a, b) => (a[0] < b[0] ? -1 : 1));
  }
}

// Runs a compiled program. `onLine` gets each line of standard error.
// Returns { code, files, errors }: the exit code, the files and the lines of standard error.
export function runProgram(module, args, memoryFiles, onLine) {
  const encoder = new TextEncoder(), decoder = new TextDecoder();
  const argBytes = args.map((arg) => encoder.encode(`${arg}\0`));
  const open = new Map();  // descriptor: {path, folder, at, flags}
  open.set(ROOT, { path: "", folder: true, at: 0 });
  let nextDescriptor = ROOT + 1;
  let memory;
  let pending = "";
  const errors = [];

  const view = () => new DataView(memory.buffer);
  const bytesAt = (at, size) => new Uint8Array(memory.buffer, at, size);
  const textAt = (at, size) => decoder.decode(bytesAt(at, size).slice());
  const pathIn = (descriptor, at, size) => {
    const folder = open.get(descriptor);
    return folder && folder.folder ? joined(folder.path, textAt(at, size)) : undefined;
  };

  function takeText(text) {
    pending += text;
    let end;
    while ((end = pending.indexOf("\n")) >= 0) {
      const line = pending.slice(0, end);
      pending = pending.slice(end + 1);
      errors.push(line);
      if (onLine) onLine(line);
    }
  }

  function writeFileStat(at, path) {
    const isFolder = memoryFiles.folders.has(path);
    const file = memoryFiles.files.get(path);
    if (!isFolder && !file) return ERRNO.noent;
    const to = view();
    bytesAt(at, 64).fill(0);
    to.setUint8(at + 16, isFolder ? TYPE.directory : TYPE.file);
    to.setBigUint64(at + 24, 1n, true);
    to.setBigUint64(at + 32, BigInt(file ? file.length : 0), true);
    return ERRNO.success;
  }

  // Sum of the sizes of a list of buffers, applied one by one.
  function forBuffers(at, count, each) {
    let sum = 0;
    for (let i = 0; i < count; i++) {
      const buffer = view().getUint32(at + 8 * i, true), size = view().getUint32(at + 8 * i + 4, true);
      const done = each(buffer, size);
      sum += done;
      if (done < size) break;
    }
    return sum;
  }

  function writeAt(file, bytes) {
    const old = memoryFiles.files.get(file.path);
    let room = file.room;
    const size = Math.max(file.size, file.at + bytes.length);
    if (!room || room.length < size) {
      room = new Uint8Array(Math.max(size, 2 * (room ? room.length : 4096)));
      room.set(old);
      file.room = room;
    }
    room.set(bytes, file.at);
    file.size = size;
    file.at += bytes.length;
    memoryFiles.files.set(file.path, room.subarray(0, size));
  }

  const wasi = {
    args_sizes_get(count, size) {
      view().setUint32(count, args.length, true);
      view().setUint32(size, argBytes.reduce((sum, arg) => sum + arg.length, 0), true);
      return ERRNO.success;
    },
    args_get(list, at) {
      for (let i = 0; i < argBytes.length; i++) {
        view().setUint32(list + 4 * i, at, true);
        bytesAt(at, argBytes[i].length).set(argBytes[i]);
        at += argBytes[i].length;
      }
      return ERRNO.success;
    },
    environ_sizes_get(count, size) {
      view().setUint32(count, 0, true);
      view().setUint32(size, 0, true);
      return ERRNO.success;
    },
    environ_get: () => ERRNO.success,
    clock_time_get(id, precision, at) {
      view().setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
      return ERRNO.success;
    },
    clock_res_get(id, at) {
      view().setBigUint64(at, 1000n, true);
      return ERRNO.success;
    },
    // No result may depend on chance: zeros show that nothing asks for it.
    random_get(at, size) {
      bytesAt(at, size).fill(0);
      return ERRNO.success;
    },
    fd_prestat_get(descriptor, at) {
      if (descriptor !== ROOT) return ERRNO.badf;
      view().setUint8(at, 0);
      view().setUint32(at + 4, 1, true);
      return ERRNO.success;
    },
    fd_prestat_dir_name(descriptor, at, size) {
      if (descriptor !== ROOT || size < 1) return ERRNO.badf;
      bytesAt(at, 1)[0] = "/".charCodeAt(0);
      return ERRNO.success;
    },
    fd_fdstat_get(descriptor, at) {
      const file = open.get(descriptor);
      if (!file && descriptor > 2) return ERRNO.badf;
      bytesAt(at, 24).fill(0);
      view().setUint8(at, !file ? TYPE.character : file.folder ? TYPE.directory : TYPE.file);
      view().setBigUint64(at + 8, 0xffffffffffffffffn, true);
      view().setBigUint64(at + 16, 0xffffffffffffffffn, true);
      return ERRNO.success;
    },
    fd_fdstat_set_flags: () => ERRNO.success,
    fd_filestat_get(descriptor, at) {
      const file = open.get(descriptor);
      if (file) return writeFileStat(at, file.path);
      if (descriptor > 2) return ERRNO.badf;
      bytesAt(at, 64).fill(0);
      view().setUint8(at + 16, TYPE.character);
      return ERRNO.success;
    },
    path_filestat_get(descriptor, flags, path, size, at) {
      const found = pathIn(descriptor, path, size);
      // The C library makes "." of an empty path, which names no file.
      if (found === "") return ERRNO.noent;
      return found === undefined ? ERRNO.badf : writeFileStat(at, found);
    },
    path_open(descriptor, lookup, path, size, flags, rights, inheriting, fdflags, at) {
      const found = pathIn(descriptor, path, size);
      if (found === undefined) return ERRNO.badf;
      const creates = (flags & 1) !== 0, wantsFolder = (flags & 2) !== 0;
      const exclusive = (flags & 4) !== 0, truncates = (flags & 8) !== 0;
      const isFolder = memoryFiles.folders.has(found), exists = memoryFiles.files.has(found);
      if (wantsFolder && !isFolder) return exists ? ERRNO.notdir : ERRNO.noent;
      if (exists && creates && exclusive) return ERRNO.exist;
      if ((creates && !exists && !isFolder) || truncates) {
        if (!found.startsWith("out/")) return ERRNO.rofs;
        memoryFiles.files.set(found, new Uint8Array(0));
      } else if (!isFolder && !exists) {
        return ERRNO.noent;
      }
      open.set(nextDescriptor, {
        path: found, folder: isFolder, at: 0, size: isFolder ? 0 : memoryFiles.files.get(found).length,
      });
      view().setUint32(at, nextDescriptor++, true);
      return ERRNO.success;
    },
    fd_close(descriptor) {
      return open.delete(descriptor) || descriptor <= 2 ? ERRNO.success : ERRNO.badf;
    },
    fd_read(descriptor, list, count, at) {
      if (descriptor === 0) {
        view().setUint32(at, 0, true);
        return ERRNO.success;
      }
      const file = open.get(descriptor);
      if (!file) return ERRNO.badf;
      if (file.folder) return ERRNO.isdir;
      const content = memoryFiles.files.get(file.path);
      const sum = forBuffers(list, count, (buffer, size) => {
        const part = content.subarray(file.at, file.at + size);
        bytesAt(buffer, part.length).set(part);
        file.at += part.length;
        return part.length;
      });
      view().setUint32(at, sum, true);
      return ERRNO.success;
    },
    fd_write(descriptor, list, count, at) {
      const file = open.get(descriptor);
      if (!file && (descriptor > 2 || descriptor === 0)) return ERRNO.badf;
      if (file && !file.path.startsWith("out/")) return ERRNO.rofs;
      const sum = forBuffers(list, count, (buffer, size) => {
        if (file) writeAt(file, bytesAt(buffer, size));
        else takeText(textAt(buffer, size));
        return size;
      });
      view().setUint32(at, sum, true);
      return ERRNO.success;
    },
    fd_seek(descriptor, offset, whence, at) {
      const file = open.get(descriptor);
      if (!file || file.folder) return ERRNO.badf;
      const size = memoryFiles.files.get(file.path).length;
      const base = whence === 0 ? 0 : whence === 1 ? file.at : size;
      const target = base + Number(offset);
      if (target < 0) return ERRNO.inval;
      file.at = target;
      view().setBigUint64(at, BigInt(target), true);
      return ERRNO.success;
    },
    fd_tell(descriptor, at) {
      return wasi.fd_seek(descriptor, 0n, 1, at);
    },
    fd_sync: () => ERRNO.success,
    fd_datasync: () => ERRNO.success,
    fd_readdir(descriptor, buffer, size, cookie, at) {
      const folder = open.get(descriptor);
      if (!folder || !folder.folder) return ERRNO.badf;
      const names = memoryFiles.list(folder.path);
      let used = 0;
      for (let i = Number(cookie); i < names.length && used < size; i++) {
        const name = encoder.encode(names[i][0]);
        const entry = new Uint8Array(24 + name.length);
        const to = new DataView(entry.buffer);
        to.setBigUint64(0, BigInt(i + 1), true);
        to.setBigUint64(8, BigInt(i + 1), true);
        to.setUint32(16, name.length, true);
        to.setUint8(20, names[i][1]);
        entry.set(name, 24);
        const part = entry.subarray(0, size - used);
        bytesAt(buffer + used, part.length).set(part);
        used += part.length;
      }
      view().setUint32(at, used, true);
      return ERRNO.success;
    },
    path_rename(from, path, size, to, newPath, newSize) {
      const source = pathIn(from, path, size), target = pathIn(to, newPath, newSize);
      if (source === undefined || target === undefined) return ERRNO.badf;
      if (!memoryFiles.files.has(source)) return ERRNO.noent;
      if (!target.startsWith("out/")) return ERRNO.rofs;
      memoryFiles.files.set(target, memoryFiles.files.get(source));
      memoryFiles.files.delete(source);
      return ERRNO.success;
    },
    path_unlink_file(descriptor, path, size) {
      const found = pathIn(descriptor, path, size);
      return found !== undefined && found.startsWith("out/") && memoryFiles.files.delete(found)
        ? ERRNO.success : ERRNO.noent;
    },
    path_readlink: (descriptor, path, size) => {
      const found = pathIn(descriptor, path, size);
      const exists = memoryFiles.files.has(found) || memoryFiles.folders.has(found);
      return exists ? ERRNO.inval : ERRNO.noent;  // nothing is a link
    },
    sched_yield: () => ERRNO.success,
    proc_exit(code) {
      throw new ExitError(code);
    },
  };
  // The C library imports more calls than the engine needs.
  const imports = new Proxy(wasi, { get: (known, name) => known[name] || (() => ERRNO.nosys) });
  const names = WebAssembly.Module.imports(module).map((each) => each.name);
  const given = Object.fromEntries(names.map((name) => [name, imports[name]]));
  const instance = new WebAssembly.Instance(module, { wasi_snapshot_preview1: given });
  memory = instance.exports.memory;
  let code = 0;
  try {
    instance.exports._start();
  } catch (error) {
    if (!(error instanceof ExitError)) throw error;
    code = error.code;
  }
  if (pending !== "") takeText("\n");
  return { code, files: memoryFiles.files, errors };
}
