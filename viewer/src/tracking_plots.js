import { el } from './dom.js';
import { Plot, plotBox } from './plot.js';
import { cssColour, motionColour } from './theme.js';

/** Tracking errors: position and rotation of a body relative to its target. */
export const ERRORS = [
  ['position', 'position', 'cm', 1],
  ['rotation', 'rotation', '\u00b0', 1],
];

/**
 * A motion's error as text; the motion may be longer than its source.
 * @param {number} time  seconds
 */
export function errorText(motion, values, time, unit, digits) {
  const at = motion.errorAt(motion.step(time));
  if (!values || at >= values.length) return '\u2013';
  return `${values[at].toFixed(digits)}\u202f${unit}`;
}

/**
 * Plots how the picked body follows its bone, one curve per motion, synchronous with the picture.
 */
export class TrackingPlots {
  constructor(player, motions) {
    this.player = player;
    this.motions = motions;
    this.plots = [];
    this.element = el('section', { 'aria-label': 'Tracking error of the selected body', hidden: true });
  }

  /** @param {string|null} body  name */
  show(body) {
    this.body = body;
    for (const { plot } of this.plots) plot.close();
    this.plots = [];
    this.element.replaceChildren();
    // Show the same body of every motion that has errors for it.
    const shown = this.motions
      .map((motion, i) => ({ motion, colour: cssColour(motionColour(i)), errors: motion.errors.get(body) }))
      .filter(({ errors }) => errors);
    this.element.hidden = shown.length === 0;
    if (shown.length === 0) return;
    this.element.append(el('h2', { text: `${body} relative to ${shown[0].errors.bone}` }));
    for (const [key, name, unit, digits] of ERRORS) this.addPlot(shown, key, name, unit, digits);
    this.showTime();
  }

  addPlot(shown, key, name, unit, digits) {
    const having = shown.filter(({ errors }) => errors[key]);
    if (having.length === 0) return;
    const { element, value } = plotBox(`${name} error, ${unit}`);
    const series = having.map(({ motion, colour, errors }) => ({
      values: errors[key],
      frameTime: motion.frameTime * motion.errorStride,
      colour,
    }));
    const plot = new Plot(
      this.player,
      series,
      { lower: null, upper: null, base: 0 },
      `${name} error of ${this.body} over time`,
    );
    element.append(plot.element);
    this.element.append(element);
    this.plots.push({
      plot,
      update: () => {
        value.textContent = having
          .map(({ motion, errors }) => errorText(motion, errors[key], this.player.time, unit, digits))
          .join('  \u00b7  ');
      },
    });
  }

  redraw() {
    this.show(this.body ?? null);
  }

  showTime() {
    for (const { plot, update } of this.plots) {
      plot.showTime();
      update();
    }
  }
}
