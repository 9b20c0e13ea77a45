import { Choice, el } from './dom.js';
import { Plot, plotBox } from './plot.js';
import { cssColour, motionColour } from './theme.js';
import { TrackingPlots } from './tracking_plots.js';

const FIRST = 4;

function spreadOf(motion, joint) {
  if (joint < 0) return 0;
  let low = Infinity,
    high = -Infinity;
  for (let frame = 0; frame < motion.frames; ++frame) {
    const value = motion.jointValue(joint, frame);
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return high - low;
}

/** The intersection of the limits of all motions: a value outside it violates one of them. */
export function commonLimits(limits) {
  const known = (end) => limits.map((each) => each[end]).filter((value) => value !== null);
  const lower = known('lower'),
    upper = known('upper');
  return {
    lower: lower.length > 0 ? Math.max(...lower) : null,
    upper: upper.length > 0 ? Math.min(...upper) : null,
  };
}

/** Curves of selected joints and of the picked body's error, synchronous with the picture. */
export class JointsPanel {
  constructor(player, motions) {
    this.player = player;
    this.motions = motions;
    this.what = 'angle';
    this.plots = new Map();
    this.names = [
      ...new Set(motions.flatMap((motion) => motion.robot.outputs.map((i) => motion.robot.joints[i].name))),
    ];
    this.select = el(
      'select',
      { 'aria-label': 'Joint to plot' },
      el('option', { value: '', text: 'Add a joint\u2026' }),
      ...this.names.map((name) => el('option', { value: name, text: name })),
    );
    this.select.addEventListener('change', () => {
      if (this.select.value) this.add(this.select.value);
      this.select.value = '';
    });
    const choice = new Choice(
      'Show',
      [
        ['angle', 'Angle'],
        ['speed', 'Speed'],
      ],
      this.what,
      (what) => {
        this.what = what;
        this.redraw();
      },
    );
    this.list = el('div');
    this.tracking = new TrackingPlots(player, motions);
    this.element = el(
      'div',
      {},
      this.tracking.element,
      el('div', { class: 'field' }, this.select, choice.element),
      this.list,
    );
    this.firstJoints().forEach((name) => this.add(name));
    player.addEventListener('time', () => this.showTime());
  }

  jointOf(motion, name) {
    return motion.robot.joints.findIndex((joint) => joint.name === name);
  }

  /** Joints with faults, worst first, then those that move most. */
  firstJoints() {
    const faulty = this.motions.flatMap((motion) =>
      (motion.report?.faults ?? []).map((fault) => fault.where),
    );
    // Use the motion in which the joint moves most.
    const spread = (name) =>
      Math.max(...this.motions.map((motion) => spreadOf(motion, this.jointOf(motion, name))));
    const spreads = new Map(this.names.map((name) => [name, spread(name)]));
    const moving = [...this.names].sort((a, b) => spreads.get(b) - spreads.get(a));
    return [...new Set([...faulty.filter((name) => this.names.includes(name)), ...moving])].slice(0, FIRST);
  }

  /** Shows a joint's curve above the others. */
  add(name) {
    if (this.plots.has(name)) {
      this.plots.get(name).element.scrollIntoView({ block: 'nearest' });
      return;
    }
    const close = el('button', {
      type: 'button',
      text: '\u00d7',
      'aria-label': `Remove ${name}`,
      on: { click: () => this.remove(name) },
    });
    const { element, value } = plotBox(name, close);
    this.plots.set(name, { element, value, plot: null });
    this.list.prepend(element);
    this.draw(name);
  }

  remove(name) {
    const { element, plot } = this.plots.get(name);
    plot.close();
    element.remove();
    this.plots.delete(name);
  }

  draw(name) {
    const entry = this.plots.get(name);
    entry.plot?.close();
    const series = [];
    const limits = [];
    this.motions.forEach((motion, i) => {
      const joint = this.jointOf(motion, name);
      if (joint < 0) return;
      const values = new Float64Array(motion.frames);
      for (let frame = 0; frame < motion.frames; ++frame) values[frame] = this.read(motion, joint, frame);
      series.push({ values, frameTime: motion.frameTime, colour: cssColour(motionColour(i)) });
      limits.push(this.limitsOf(motion, joint));
    });
    entry.plot = new Plot(this.player, series, commonLimits(limits), `${this.what} of ${name} over time`);
    entry.element.append(entry.plot.element);
    this.showTime();
  }

  read(motion, joint, frame) {
    return this.what === 'angle' ? motion.jointValue(joint, frame) : motion.jointSpeed(joint, frame);
  }

  limitsOf(motion, joint) {
    if (this.what === 'angle') {
      const [lower, upper] = motion.data.limits[joint];
      return { lower, upper };
    }
    const speed = motion.robot.joints[joint].speed ?? null;
    return { lower: speed === null ? null : -speed, upper: speed };
  }

  /** @param {string|null} body  name of the picked body */
  showBody(body) {
    this.tracking.show(body);
  }

  redraw() {
    this.tracking.redraw();
    for (const name of this.plots.keys()) this.draw(name);
  }

  showTime() {
    if (this.element.offsetParent === null) return;
    this.tracking.showTime();
    for (const [name, { value, plot }] of this.plots) {
      plot?.showTime();
      value.textContent = this.motions
        .map((motion) => {
          const joint = this.jointOf(motion, name);
          if (joint < 0) return '';
          const unit =
            (motion.robot.joints[joint].slides ? 'm' : 'rad') + (this.what === 'angle' ? '' : '/s');
          const value = this.read(motion, joint, motion.frameAt(this.player.time));
          return `${value.toFixed(3)}\u202f${unit}`;
        })
        .filter(Boolean)
        .join('  \u00b7  ');
    }
  }
}
