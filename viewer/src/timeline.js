import { byId, el, numberText, seconds } from './dom.js';
import { ROBOT_CONTACT, SOURCE_CONTACT, cssColour, motionColour } from './theme.js';
import { touchRows } from './touches.js';

/** Kinds of faults in the order of their lanes, with labels. */
export const KINDS = new Map([
  ['jump', 'Jumps'],
  ['penetration', 'Floor penetration'],
  ['floating', 'Floating'],
  ['slip', 'Slips'],
  ['self-collision', 'Self-collision'],
  ['limit', 'Limits'],
  ['speed', 'Speed'],
  ['lean', 'Lean'],
  ['scene', 'Scene'],
  ['other', 'Other'],
]);

/** Total faults by kind. Reports, and so the lists, contain only the worst ones per metric. */
export function totalsByKind(motions) {
  const totals = new Map();
  for (const { report } of motions) {
    const metrics = new Map();
    for (const { metric, kind } of report?.faults ?? []) {
      const listed = metrics.get(metric)?.listed ?? 0;
      metrics.set(metric, { kind, listed: listed + 1 });
    }
    for (const [metric, { kind, listed }] of metrics) {
      const count = Math.max(listed, report.fault_totals?.[metric] ?? 0);
      totals.set(kind, (totals.get(kind) ?? 0) + count);
    }
  }
  return totals;
}

/** Text such as `3`, or `worst 10 of 37` if not all faults are listed. */
export function countText(listed, total) {
  return total > listed ? `worst ${listed} of ${total}` : String(listed);
}

export function faultText(fault, motion) {
  const amount = `${numberText(fault.amount)} ${fault.unit}`;
  const where = fault.where || fault.label;
  return `${KINDS.get(fault.kind)}: ${where}, ${amount} at ${seconds(fault.worst * motion.frameTime)}`;
}

/** The scrubber, the lanes of faults by kind, the stance phases, and contacts with a scene. */
export class Timeline {
  constructor(player, motions, onFault) {
    this.player = player;
    this.motions = motions;
    this.onFault = onFault;
    this.lanes = byId('lanes');
    this.playhead = el('div', { id: 'playhead' });
    this.loop = el('div', { class: 'loop', hidden: true });
    this.marks = [];
    this.contacts = [];
    this.addScrubber();
    this.addFaults();
    this.addContacts();
    this.addTouches();
    this.overlay = el('div', { 'aria-hidden': 'true' }, this.loop, this.playhead);
    Object.assign(this.overlay.style, {
      position: 'absolute',
      top: '0',
      bottom: '0',
      right: '0',
      pointerEvents: 'none',
    });
    this.lanes.append(this.overlay);
    player.addEventListener('time', () => this.showTime());
    player.addEventListener('state', () => this.showRange());
    new ResizeObserver(() => this.resize()).observe(this.lanes);
    this.resize();
  }

  row(name, lane, title) {
    this.lanes.append(el('span', { class: 'name', text: name, title }), lane);
    return lane;
  }

  share(time) {
    return this.player.duration > 0 ? Math.min(1, Math.max(0, time / this.player.duration)) : 0;
  }

  addScrubber() {
    const { player } = this;
    this.scrub = el('input', {
      type: 'range',
      min: 0,
      max: Math.round(player.duration / player.frameTime),
      step: 1,
      value: 0,
      'aria-label': 'Time',
    });
    this.scrub.addEventListener('input', () => player.seekFrame(Number(this.scrub.value)));
    this.row('Time', el('div', { class: 'scrub' }, this.scrub));
  }

  addFaults() {
    const count = this.motions.length;
    const totals = totalsByKind(this.motions);
    for (const [kind, name] of KINDS) {
      const lane = el('div', { class: 'lane' });
      this.motions.forEach((motion, i) => {
        for (const fault of motion.report?.faults ?? []) {
          if (fault.kind === kind) lane.append(this.mark(fault, motion, i, count));
        }
      });
      if (lane.childElementCount > 0) this.row(name, lane, countText(lane.childElementCount, totals.get(kind)));
    }
  }

  mark(fault, motion, index, count) {
    const text = (count > 1 ? `${motion.label}: ` : '') + faultText(fault, motion);
    // Marks are not in the tab order, because keyboard users have the list of faults.
    const mark = el('button', {
      type: 'button',
      class: `mark ${fault.kind}`,
      tabindex: -1,
      title: text,
      'aria-label': text,
    });
    const begin = this.share(fault.begin * motion.frameTime),
      end = this.share(fault.end * motion.frameTime);
    Object.assign(mark.style, {
      left: `${100 * Math.min(begin, 0.995)}%`,
      width: `${100 * Math.max(0, end - begin)}%`,
      top: `${(100 * index) / count}%`,
      height: `${100 / count}%`,
    });
    mark.addEventListener('click', () => this.onFault(fault, motion));
    this.marks.push({ mark, fault });
    return mark;
  }

  addContacts() {
    for (const [side, name, ends] of [
      ['left', 'Left foot', [0, 1]],
      ['right', 'Right foot', [2, 3]],
    ]) {
      const bands = [];
      const sources = new Set();
      for (const motion of this.motions) {
        if (motion.human && !sources.has(motion.data.human)) {
          sources.add(motion.data.human);
          bands.push({
            colour: SOURCE_CONTACT,
            motion,
            phases: ends.map((end) => motion.human.contacts[end] ?? []),
            alpha: 0.5,
            label: motion.report?.source || 'the human',
          });
        }
        const robot = motion.data.contacts.filter((each) => each.side === side).map((each) => each.phases);
        if (robot.length > 0) {
          // Bands of several motions have the colours of their robots.
          const colour = this.motions.length > 1 ? motionColour(motion.index) : ROBOT_CONTACT;
          bands.push({ colour, motion, phases: robot, alpha: 0.9, label: motion.label });
        }
      }
      if (bands.length === 0) continue;
      const title =
        this.motions.length > 1
          ? `In contact, from top to bottom: ${bands.map(({ label }) => label).join(', ')}`
          : 'In contact: the human\u2019s foot above (heel and toe), the robot\u2019s below';
      this.bandRow(name, bands, title);
    }
  }

  bandRow(name, bands, title) {
    const canvas = el('canvas', { 'aria-hidden': 'true' });
    Object.assign(canvas.style, { width: '100%', height: '100%', display: 'block' });
    this.row(name, el('div', { class: 'lane' }, canvas), title);
    this.contacts.push({ canvas, bands });
  }

  addTouches() {
    const { rows, others } = touchRows(this.motions);
    for (const { name, keys, bands } of rows) {
      const drawn = bands.map((band) => ({ ...band, colour: SOURCE_CONTACT, alpha: 0.9 }));
      const whose = bands.length > 1 ? `, for ${bands.map(({ motion }) => motion.label).join(', ')}` : '';
      this.bandRow(name, drawn, `${name}: contacts of the human${whose} (${keys.join(', ')})`);
    }
    if (others.length > 0) this.row(`${others.length} more`, el('div', { class: 'lane thin' }), others.join(', '));
  }

  drawContacts({ canvas, bands }) {
    const width = canvas.clientWidth,
      height = canvas.clientHeight,
      ratio = window.devicePixelRatio;
    if (width === 0) return;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const context = canvas.getContext('2d');
    context.scale(ratio, ratio);
    const band = height / bands.length;
    bands.forEach(({ colour, motion, phases, alpha }, i) => {
      context.fillStyle = cssColour(colour);
      context.globalAlpha = alpha;
      for (const list of phases) {
        for (const [begin, end] of list) {
          const from = this.share(begin * motion.frameTime) * width,
            to = this.share((end - 1) * motion.frameTime) * width;
          context.fillRect(from, i * band + 0.5, Math.max(1, to - from), band - 1);
        }
      }
    });
  }

  resize() {
    const track = this.scrub.parentElement;
    this.overlay.style.left = `${track.offsetLeft}px`;
    this.width = track.clientWidth;
    for (const each of this.contacts) this.drawContacts(each);
    this.showTime();
    this.showRange();
  }

  showTime() {
    const time = Math.min(this.player.time, this.player.duration);
    this.scrub.value = String(this.player.frame);
    this.scrub.setAttribute(
      'aria-valuetext',
      `${time.toFixed(2)} of ${this.player.duration.toFixed(2)} seconds`,
    );
    this.playhead.style.transform = `translateX(${this.share(time) * (this.width ?? 0) - 1}px)`;
  }

  showRange() {
    const { begin, end, duration } = this.player;
    this.loop.hidden = begin === 0 && end === duration;
    this.loop.style.left = `${this.share(begin) * 100}%`;
    this.loop.style.width = `${(this.share(end) - this.share(begin)) * 100}%`;
  }

  /** @param {object|null} chosen  the selected fault */
  showFault(chosen) {
    for (const { mark, fault } of this.marks) {
      if (fault === chosen) mark.setAttribute('aria-current', 'true');
      else mark.removeAttribute('aria-current');
    }
  }
}
