/** Rows of the timeline for contacts with a scene, without a document. */

/** Most rows of contacts with a scene; the others are only counted. */
const MAX_ROWS = 12;

/** Plain name of a part: `left_hand` is a left hand; heel and toe are ends of a foot. */
function partName(part) {
  const words = part.replace(/_(heel|toe)$/, '_foot').replaceAll('_', ' ');
  return words[0].toUpperCase() + words.slice(1);
}

const length = (phases) => phases.reduce((sum, [begin, end]) => sum + end - begin, 0);

/**
 * Contacts of motions with bodies of their scenes, by part and surface. Motions of one source have
 * the same contacts, so only the first of them counts.
 * @param {import('./motions.js').Motion[]} motions
 * @returns {{rows: {name: string, keys: string[], bands: {motion: object, phases: number[][][]}[]}[],
 *     others: string[]}}  names of further rows, which have the shortest contacts
 */
export function touchRows(motions) {
  const rows = new Map();
  const sources = new Set();
  for (const motion of motions) {
    const source = motion.data.human;
    if (source !== undefined && sources.has(source)) continue;
    sources.add(source);
    for (const { part, surface, phases } of motion.touches) {
      const name = `${partName(part)}: ${surface}`;
      if (!rows.has(name)) rows.set(name, { name, keys: new Set(), bands: [], total: 0 });
      const row = rows.get(name);
      row.keys.add(`${part}:${surface}`);
      let band = row.bands.find((each) => each.motion === motion);
      if (!band) row.bands.push((band = { motion, phases: [] }));
      band.phases.push(phases);
      row.total += length(phases) * motion.frameTime;
    }
  }
  const all = [...rows.values()].map((row) => ({ ...row, keys: [...row.keys] }));
  const longest = [...all].sort((a, b) => b.total - a.total).slice(0, MAX_ROWS);
  return {
    rows: all.filter((row) => longest.includes(row)),
    others: all.filter((row) => !longest.includes(row)).map((row) => row.name),
  };
}
