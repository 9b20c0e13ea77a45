/** The page of a gallery: lists the clips of a batch. Text from files is never parsed as markup. */
import { byId, el } from './dom.js';

const gallery = JSON.parse(byId('gallery').textContent);

const count = (number, noun) => `${number} ${noun}${number === 1 ? '' : 's'}`;
const unitText = (unit) => (unit === '1' || unit === 'count' ? '' : ` ${unit}`);

function verdict(clip) {
  if (clip.failed) return ['bad', 'failed'];
  if (!clip.missed) return ['', 'not measured'];
  return clip.missed.length === 0
    ? ['good', 'all gates passed']
    : ['bad', `${count(clip.missed.length, 'gate')} missed`];
}

const labels = new Map(gallery.metrics.map((metric) => [metric.key, metric.label]));
const labelOf = (key) => labels.get(key) ?? key;

/** Creates the card of a clip. */
function card(clip) {
  const [kind, text] = verdict(clip);
  const [width, height] = gallery.thumbnail;
  clip.shownFigure = el('span', { class: 'figure' });
  const content = [
    clip.picture
      ? el(
          'div',
          { class: 'picture' },
          el('img', { src: clip.picture, alt: '', loading: 'lazy', width, height }),
        )
      : null,
    el(
      'div',
      { class: 'text' },
      el('h2', { text: clip.name }),
      el(
        'div',
        { class: 'facts' },
        el('span', { class: `badge ${kind}`, text, title: clip.missed?.map(labelOf).join(', ') || null }),
        clip.seconds === undefined ? null : el('span', { text: `${clip.seconds}\u202fs` }),
        robots.length > 1 ? el('span', { text: clip.robot }) : null,
        clip.shownFigure,
      ),
      clip.message ? el('p', { class: 'message', text: clip.message }) : null,
    ),
  ];
  return clip.page
    ? el('a', { class: 'clip', href: clip.page }, ...content)
    : el('div', { class: 'clip' }, ...content);
}

const robots = [...new Set(gallery.clips.map((clip) => clip.robot))].sort();
gallery.clips.forEach((clip, i) => {
  clip.order = i;
  clip.text = clip.name.toLowerCase();
  clip.card = card(clip);
});

const missedGates = [...new Set(gallery.clips.flatMap((clip) => clip.missed ?? []))];
const metricKeys = gallery.metrics.map((metric) => metric.key);
missedGates.sort((a, b) => metricKeys.indexOf(a) - metricKeys.indexOf(b));

function addOptions() {
  const option = (value, text, title) => el('option', { value, text, title });
  byId('sort').append(
    option('passed', 'Passed first'),
    option('worst', 'Worst first'),
    option('name', 'Name'),
    option('seconds', 'Length'),
    el(
      'optgroup',
      { label: 'Metric' },
      ...gallery.metrics.map((metric, i) =>
        option(
          `figure ${i}`,
          metric.label + (unitText(metric.unit) && `,${unitText(metric.unit)}`),
          `${metric.key}: ${metric.definition}`,
        ),
      ),
    ),
  );
  byId('filter').append(
    option('', 'all'),
    option('kept', 'all gates passed'),
    option('missed', 'at least one gate missed'),
    option('failed', 'failed or incomplete'),
    el('optgroup', { label: 'Gate missed' }, ...missedGates.map((key) => option(`gate ${key}`, labelOf(key), key))),
  );
  byId('robots').append(option('', 'all'), ...robots.map((robot) => option(`robot ${robot}`, robot)));
  byId('robots-label').hidden = robots.length < 2;
}

const FILTERS = {
  '': () => true,
  kept: (clip) => clip.missed?.length === 0,
  missed: (clip) => clip.missed?.length > 0,
  failed: (clip) => clip.failed || Boolean(clip.message),
};

function isShown(clip, words, filter, robot) {
  if (!words.every((word) => clip.text.includes(word))) return false;
  if (robot && robot !== `robot ${clip.robot}`) return false;
  return filter.startsWith('gate ') ? Boolean(clip.missed?.includes(filter.slice(5))) : FILTERS[filter](clip);
}

/** Sorts clips by the selected key; clips without a value come last in both directions. */
function sorted(clips, sort, turned) {
  const sign = turned ? -1 : 1;
  if (sort === 'passed') return [...clips].sort((a, b) => sign * (a.rank - b.rank || a.order - b.order));
  if (sort === 'worst') return [...clips].sort((a, b) => sign * (a.order - b.order));
  if (sort === 'name')
    return [...clips].sort(
      (a, b) => sign * a.name.localeCompare(b.name, undefined, { numeric: true }) || a.order - b.order,
    );
  const value = sort === 'seconds' ? (clip) => clip.seconds : (clip) => clip.figures?.[Number(sort.slice(7))];
  return [...clips].sort((a, b) => {
    const [x, y] = [value(a) ?? null, value(b) ?? null];
    if (x === null || y === null) return Number(x === null) - Number(y === null) || a.order - b.order;
    // The largest value comes first.
    return sign * (y - x) || a.order - b.order;
  });
}

function show() {
  const [sort, filter, robot] = ['sort', 'filter', 'robots'].map((id) => byId(id).value);
  const words = byId('search').value.toLowerCase().split(/\s+/).filter(Boolean);
  const turned = byId('turn').getAttribute('aria-pressed') === 'true';
  const shown = sorted(
    gallery.clips.filter((clip) => isShown(clip, words, filter, robot)),
    sort,
    turned,
  );
  const figure = sort.startsWith('figure ') ? Number(sort.slice(7)) : -1;
  for (const clip of shown) {
    const value = figure < 0 ? undefined : clip.figures?.[figure];
    clip.shownFigure.textContent =
      value === undefined || value === null ? '' : `${value}${unitText(gallery.metrics[figure].unit)}`;
  }
  // In the order in which the page opens, failures are folded, unless nothing else is shown.
  const failed = sort === 'passed' ? shown.filter((clip) => clip.failed) : [];
  const folded = failed.length < shown.length ? failed : [];
  byId('clips').replaceChildren(
    ...shown.filter((clip) => !folded.includes(clip)).map((clip) => clip.card),
  );
  byId('failed').hidden = folded.length === 0;
  byId('failed-count').textContent = `${count(folded.length, 'clip')} failed`;
  byId('failed-clips').replaceChildren(...folded.map((clip) => clip.card));
  byId('nothing').hidden = shown.length > 0;
  const all = gallery.clips.length;
  byId('count').textContent =
    shown.length === all ? count(all, 'clip') : `${shown.length} of ${count(all, 'clip')}`;
}

byId('title').textContent = gallery.title;
addOptions();
byId('tools').addEventListener('submit', (event) => event.preventDefault());
byId('tools').addEventListener('input', show);
byId('turn').addEventListener('click', () => {
  byId('turn').setAttribute('aria-pressed', String(byId('turn').getAttribute('aria-pressed') !== 'true'));
  show();
});
document.addEventListener('keydown', (event) => {
  if (event.key !== '/' || event.target instanceof HTMLInputElement) return;
  event.preventDefault();
  byId('search').focus();
});
show();
