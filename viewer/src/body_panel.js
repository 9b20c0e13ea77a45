import { el, numberText } from './dom.js';
import { ERRORS, errorText } from './tracking_plots.js';

const boundText = (value, none) => (value === null ? none : numberText(value));

/** Details of a picked body: its pose, its joints, and how it follows its bone. */
export class BodyPanel {
  /** @param {(joint: string|null) => void} onPlot  plots a joint, or the picked body's error */
  constructor(player, motions, onPick, onPlot) {
    this.player = player;
    this.motions = motions;
    this.onPlot = onPlot;
    this.motion = motions[0];
    this.body = null;
    this.select = el('select', { 'aria-label': 'Body' });
    this.select.addEventListener('change', () =>
      onPick(this.motion.index, this.select.value === '' ? null : Number(this.select.value)),
    );
    this.content = el('div');
    this.element = el('div', {}, el('div', { class: 'field' }, this.select), this.content);
    this.fillSelect();
    this.show(null, null);
    player.addEventListener('time', () => this.showTime());
  }

  fillSelect() {
    const { bodies } = this.motion.robot;
    this.select.replaceChildren(
      el('option', { value: '', text: 'Choose a body, or click one in the 3D view' }),
      ...bodies
        .map((body, i) => [i, body])
        .slice(1)
        .map(([i, body]) => el('option', { value: i, text: body.name || `body ${i}` })),
    );
  }

  /** @param {number|null} motion  @param {number|null} body */
  show(motion, body) {
    if (motion !== null && this.motions[motion].robot !== this.motion.robot) {
      this.motion = this.motions[motion];
      this.fillSelect();
    } else if (motion !== null) {
      this.motion = this.motions[motion];
    }
    this.body = body;
    this.select.value = body === null ? '' : String(body);
    this.live = [];
    if (body === null) {
      this.content.replaceChildren(
        el('p', { class: 'quiet', text: 'Shows the name, joints and tracking error of the body.' }),
      );
      return;
    }
    // Show the same body of every motion of this robot.
    this.shown = this.motions.filter((each) => each.robot === this.motion.robot);
    this.content.replaceChildren(
      ...[...this.placeTable(), ...this.jointTable(), ...this.trackingTable()].filter(Boolean),
    );
    this.showTime();
  }

  heads(first) {
    return el(
      'thead',
      {},
      el(
        'tr',
        {},
        el('th', { scope: 'col', text: first }),
        ...this.shown.map((motion) =>
          el('th', { scope: 'col', class: 'number', text: motion.label, title: motion.label }),
        ),
      ),
    );
  }

  // A row of values that change with time.
  liveRow(name, read) {
    const cells = this.shown.map((motion) => {
      const cell = el('td', { class: 'number' });
      this.live.push(() => {
        cell.textContent = read(motion, motion.frameAt(this.player.time));
      });
      return cell;
    });
    return el('tr', {}, typeof name === 'string' ? el('th', { scope: 'row', text: name }) : name, ...cells);
  }

  placeTable() {
    const rows = ['x', 'y', 'z'].map((axis, i) =>
      this.liveRow(`${axis}, m`, (motion, frame) => motion.bodyPoses(frame)[7 * this.body + i].toFixed(3)),
    );
    const { bodies } = this.motion.robot;
    const parent = bodies[bodies[this.body].parent].name;
    return [
      el('h2', { text: bodies[this.body].name }),
      el('p', { class: 'quiet', text: parent ? `attached to ${parent}` : '' }),
      el('table', {}, this.heads('Position'), el('tbody', {}, ...rows)),
    ];
  }

  jointTable() {
    const { joints } = this.motion.robot;
    const own = joints.map((joint, i) => [joint, i]).filter(([joint]) => joint.body === this.body);
    if (own.length === 0)
      return [el('p', { class: 'quiet', text: 'This body is fixed to its parent.' })];
    const rows = own.flatMap(([joint, i]) => {
      const [lower, upper] = this.motion.data.limits[i];
      const unit = joint.slides ? 'm' : 'rad';
      const plot = el('button', {
        type: 'button',
        text: 'Plot',
        on: { click: () => this.onPlot(joint.name) },
      });
      const name = el(
        'th',
        { scope: 'row' },
        joint.name,
        ' ',
        plot,
        el('small', {
          class: 'quiet',
          text: ` limits ${boundText(lower, '\u2212\u221e')} to ${boundText(upper, '\u221e')} ${unit}`,
        }),
      );
      return [
        this.liveRow(name, (motion, frame) => `${motion.jointValue(i, frame).toFixed(3)} ${unit}`),
        this.liveRow('speed', (motion, frame) => `${motion.jointSpeed(i, frame).toFixed(2)} ${unit}/s`),
      ];
    });
    return [
      el('h2', { text: own.length > 1 ? 'Joints' : 'Joint' }),
      el('table', {}, this.heads('Now'), el('tbody', {}, ...rows)),
    ];
  }

  trackingTable() {
    const { name } = this.motion.robot.bodies[this.body];
    const rows = this.shown.flatMap((motion) =>
      (motion.report?.tracking ?? []).filter((row) => row.body === name),
    );
    if (rows.length === 0) return [];
    // The second table is used for evaluation if there is one.
    const table = Math.max(...rows.map((row) => row.table));
    const find = (motion) => motion.report?.tracking.find((row) => row.body === name && row.table === table);
    const cell = (row, mean, high) =>
      el('td', {
        class: 'number',
        text: row?.[mean] === undefined ? '\u2013' : `${numberText(row[mean])} (${numberText(row[high])})`,
      });
    const now = ERRORS.filter(([key]) => this.shown.some((motion) => motion.errors.get(name)?.[key])).map(
      ([key, what, unit, digits]) =>
        this.liveRow(`${what}, ${unit}`, (motion) =>
          errorText(motion, motion.errors.get(name)?.[key], this.player.time, unit, digits),
        ),
    );
    const curves = el('button', { type: 'button', text: 'Plot', on: { click: () => this.onPlot(null) } });
    return [
      el('h2', { text: `Tracking error relative to ${rows[0].bone}` }),
      now.length > 0 ? el('table', {}, this.heads('Now'), el('tbody', {}, ...now)) : null,
      now.length > 0 ? el('p', {}, curves) : null,
      el(
        'table',
        {},
        this.heads('Mean (95th percentile)'),
        el(
          'tbody',
          {},
          el(
            'tr',
            {},
            el('th', { scope: 'row', text: 'position, cm' }),
            ...this.shown.map((motion) => cell(find(motion), 'position_cm', 'position_p95_cm')),
          ),
          el(
            'tr',
            {},
            el('th', { scope: 'row', text: 'rotation, \u00b0' }),
            ...this.shown.map((motion) => cell(find(motion), 'rotation_deg', 'rotation_p95_deg')),
          ),
        ),
      ),
    ];
  }

  showTime() {
    if (this.body === null || this.element.offsetParent === null) return;
    for (const update of this.live) update();
  }
}
