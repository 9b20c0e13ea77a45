/** Reads the data packed into the page: the header and the tracks (src/view/scene_data.h). */

/**
 * Reverses folding, differencing and rounding of one track.
 * @param {Uint8Array} bytes  of this track
 * @param {{channels: number, frames: number, step: number}} track
 * @returns {Float64Array} frame-major, `channels` values per frame
 */
export function unpackTrack(bytes, { channels, frames, step }) {
  const plane = channels * frames;
  const values = new Float64Array(plane);
  const channel = new Int32Array(frames);
  for (let c = 0; c < channels; ++c) {
    for (let i = 0; i < frames; ++i) {
      const at = channels + c * frames + i;
      const folded =
        bytes[at] | (bytes[at + plane] << 8) | (bytes[at + 2 * plane] << 16) | (bytes[at + 3 * plane] << 24);
      channel[i] = (folded >>> 1) ^ -(folded & 1);
    }
    for (let order = bytes[c]; order > 0; --order) {
      for (let i = 1; i < frames; ++i) channel[i] = (channel[i] + channel[i - 1]) | 0;
    }
    for (let i = 0; i < frames; ++i) values[i * channels + c] = channel[i] * step;
  }
  return values;
}

// Reads deflated base64 data from an element.
async function readElement(id) {
  const element = document.getElementById(id);
  const text = atob(element.textContent);
  // The data are read only once, so free the memory.
  element.remove();
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** @returns {Promise<object>} the header: robots, humans, motions, tracks */
export async function readHeader() {
  return JSON.parse(new TextDecoder().decode(await readElement('page-header')));
}

/**
 * @param {object[]} tracks  from the header
 * @returns {Promise<Float64Array[]>}
 */
export async function readTracks(tracks) {
  const bytes = await readElement('page-tracks');
  let at = 0;
  return tracks.map((track) => {
    const size = track.channels + 4 * track.channels * track.frames;
    const values = unpackTrack(bytes.subarray(at, at + size), track);
    at += size;
    return values;
  });
}
