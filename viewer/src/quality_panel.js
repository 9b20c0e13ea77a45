import { el, numberText } from './dom.js';

const valueText = (figure) =>
  figure === undefined
    ? '\u2013'
    : numberText(figure.value) + (figure.p95 === undefined ? '' : ` (${numberText(figure.p95)})`);

const unitText = (unit) => (unit === '1' || unit === 'count' ? '' : unit);

const boundText = ({ min, max, unit }) =>
  [
    ['\u2265', min],
    ['\u2264', max],
  ]
    .filter(([, bound]) => bound !== undefined)
    .map(([sign, bound]) => `${sign} ${numberText(bound)} ${unitText(unit)}`.trim())
    .join('\n');

/**
 * Describes how many gates a motion misses.
 * @returns {{state: 'good'|'bad'|'unjudged', text: string}}
 */
export function verdict(motion) {
  const { gates, estimated_soles: estimated } = motion.report;
  const measured = gates.filter((gate) => gate.value !== undefined).length;
  const missed = gates.filter((gate) => !gate.passed).length;
  if (measured === 0) return { state: 'unjudged', text: 'no gates' };
  const unmeasured = measured < gates.length ? `, ${gates.length - measured} not measured` : '';
  const rest = unmeasured + (estimated ? ', soles estimated' : '');
  if (missed === 0) return { state: 'good', text: `all ${measured} gates passed${rest}` };
  return { state: 'bad', text: `${missed} of ${measured} gates missed${rest}` };
}

/** The result of a gate, as a table cell. */
function gateState(gate) {
  if (gate?.value === undefined) return el('span', { class: 'quiet', title: 'not measured', text: '\u2013' });
  const [mark, word] = gate.passed ? ['\u2713', 'good'] : ['\u2717', 'bad'];
  return el('span', { class: `state ${word}`, text: `${mark} ${numberText(gate.value)}` });
}

function head(names, motions) {
  return el(
    'thead',
    {},
    el(
      'tr',
      {},
      ...names.map((name) => el('th', { scope: 'col', text: name })),
      ...motions.map((motion) =>
        el('th', { scope: 'col', class: 'number', text: motion.label, title: motion.label }),
      ),
    ),
  );
}

function gateTable(motions) {
  const names = [...new Set(motions.flatMap((motion) => motion.report.gates.map((gate) => gate.metric)))];
  const rows = names.map((name) => {
    const gates = motions.map((motion) => motion.report.gates.find((gate) => gate.metric === name));
    const cells = gates.map((gate) => el('td', { class: 'number' }, gateState(gate)));
    return {
      missed: gates.some((gate) => gate && !gate.passed),
      row: el(
        'tr',
        {},
        el('th', { scope: 'row', title: name, text: gates.find(Boolean).label }),
        el('td', {
          class: 'quiet bound',
          text: [...new Set(gates.filter(Boolean).map(boundText))].join(' / '),
        }),
        ...cells,
      ),
    };
  });
  // Missed gates come first.
  rows.sort((a, b) => Number(b.missed) - Number(a.missed));
  return el('table', {}, head(['Gate', 'Bound'], motions), el('tbody', {}, ...rows.map(({ row }) => row)));
}

function figureTable(motions) {
  const figures = new Map(
    motions.flatMap((motion) => motion.report.figures.map((figure) => [figure.key, figure])),
  );
  const rows = [...figures].map(([key, { label, unit, definition }]) =>
    el(
      'tr',
      { title: `${key}: ${definition}` },
      el('th', { scope: 'row', text: label }),
      el('td', { class: 'quiet', text: unitText(unit) }),
      ...motions.map((motion) =>
        el('td', {
          class: 'number',
          text: valueText(motion.report.figures.find((figure) => figure.key === key)),
        }),
      ),
    ),
  );
  return el('table', {}, head(['Metric', 'Unit'], motions), el('tbody', {}, ...rows));
}

/** Gates and metrics of all motions side by side. All values come from the tool. */
export function qualityPanel(motions) {
  const measured = motions.filter((motion) => motion.report);
  if (measured.length === 0) return el('p', { class: 'quiet', text: 'The quality of these motions was not measured.' });
  // Show the values of all motions if they differ.
  const fact = (name, key) => {
    const values = measured.map((motion) => motion.report[key]);
    if (new Set(values).size <= 1) return values[0] ? `${name}: ${values[0]}.` : '';
    return `${name}: ${measured.map((motion, i) => `${values[i] || 'none'} (${motion.label})`).join(', ')}.`;
  };
  const facts = [
    fact('Source', 'source'),
    fact('Configuration', 'config'),
    fact('Limits', 'limits'),
  ].filter(Boolean);
  return el(
    'div',
    {},
    el('h2', { text: 'Gates' }),
    gateTable(measured),
    el('h2', { text: 'Metrics' }),
    figureTable(measured),
    el('p', {
      class: 'quiet',
      text:
        `${facts.join(' ')} Parentheses contain the 95th percentile. ` +
        'Hover over a row for its definition.',
    }),
  );
}
