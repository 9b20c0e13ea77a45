import { byId, el } from './dom.js';

/** Keys as in media players, and their actions. */
const KEYS = [
  [['Space'], 'Play or pause'],
  [['\u2190', '\u2192'], 'Back or forward one second (with Shift: 0.1 s)'],
  [[',', '.'], 'Back or forward one frame'],
  [['P', 'N'], 'Previous or next fault'],
  [['[', ']'], 'Previous or next fault; in a gallery, previous or next clip'],
  [['Home', 'End'], 'Go to the start or end'],
  [['\u2212', '+'], 'Play slower or faster'],
  [['I', 'O'], 'Set the start or end of the loop'],
  [['X', 'L'], 'Play the whole motion; toggle looping'],
  [['F'], 'Camera follows the robot, or is fixed'],
  [['R'], 'Reset the camera'],
  [['H'], 'Human beside the robot, over it, or hidden'],
  [['?'], 'Show these keys'],
];

/** @param {Record<string, (event: KeyboardEvent) => void>} actions  by key name */
export function addKeyboard(actions) {
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || byId('help').open) return;
    const { target } = event;
    const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const types =
      target instanceof HTMLSelectElement || (target instanceof HTMLInputElement && target.type !== 'range');
    if (types) return;
    // Keys with a meaning for the focused control keep it.
    if (name === ' ' && (target instanceof HTMLButtonElement || target.getAttribute?.('role') === 'tab'))
      return;
    if (target instanceof HTMLInputElement && /^(Arrow|Home|End|Page)/.test(name)) return;
    const action = actions[name];
    if (!action) return;
    event.preventDefault();
    action(event);
  });
}

/** The dialog that lists the keys. @param {string[]} notes  shown below the keys */
export function addHelp(notes) {
  const dialog = byId('help');
  dialog.append(
    el('h2', { id: 'help-title', text: 'Keys' }),
    el(
      'table',
      {},
      el(
        'tbody',
        {},
        ...KEYS.map(([keys, what]) =>
          el(
            'tr',
            {},
            el('td', {}, ...keys.flatMap((key) => [el('kbd', { text: key }), ' '])),
            el('td', { text: what }),
          ),
        ),
      ),
    ),
    ...notes.map((text) => el('p', { text })),
    el('form', { method: 'dialog' }, el('button', { text: 'Close' })),
  );
  byId('help-button').addEventListener('click', () => dialog.showModal());
  return () => dialog.showModal();
}
