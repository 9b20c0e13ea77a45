// Files of a bundle (browser/make_page.py): a little-endian 32-bit length, an index of that many bytes of JSON
// `[[path, size], ...]`, and the files one after the other. Returns [[path, Uint8Array], ...].
export function unpackBundle(bytes) {
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true);
  const index = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
  let at = 4 + length;
  return index.map(([path, size]) => {
    at += size;
    return [path, bytes.subarray(at - size, at)];
  });
}
