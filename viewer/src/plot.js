import { el } from './dom.js';

const PAD = 5;

/** The frame of a plot: name, current values, optional button. @returns {{element, value}} */
export function plotBox(name, button = null) {
  const value = el('span', { class: 'number quiet' });
  const element = el('div', { class: 'plot' }, el('header', {}, el('b', { text: name }), value, button));
  return { element, value };
}

/** Plots a curve over time for each motion, with shaded limits; a click seeks to that time. */
export class Plot {
  /**
   * @param {import('./player.js').Player} player
   * @param {{values: Float64Array|number[], frameTime: number, colour: string}[]} series
   * @param {{lower: number|null, upper: number|null, base?: number}} limits  base: lower end of the
   *     axis
   */
  constructor(player, series, limits, name) {
    this.player = player;
    this.series = series;
    this.limits = limits;
    this.canvas = el('canvas', { role: 'img', 'aria-label': name });
    this.cursor = el('div', { class: 'cursor' });
    this.element = el('div', { class: 'area' }, this.canvas, this.cursor);
    const seek = (event) => {
      const box = this.element.getBoundingClientRect();
      player.seek(((event.clientX - box.left) / box.width) * player.duration);
    };
    this.element.addEventListener('pointerdown', (event) => {
      this.element.setPointerCapture(event.pointerId);
      player.pause();
      seek(event);
    });
    this.element.addEventListener('pointermove', (event) => {
      if (event.buttons & 1) seek(event);
    });
    this.observer = new ResizeObserver(() => this.draw());
    this.observer.observe(this.element);
  }

  /** Range of the curves, including limits that are near. */
  range() {
    let low = Infinity,
      high = -Infinity;
    for (const { values } of this.series) {
      for (const value of values) {
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    }
    const reach = Math.max(0.2, high - low);
    const { lower, upper } = this.limits;
    if (lower !== null && lower > low - reach) low = Math.min(low, lower);
    if (upper !== null && upper < high + reach) high = Math.max(high, upper);
    const { base } = this.limits;
    if (base !== undefined) low = Math.min(low, base);
    const margin = 0.06 * Math.max(high - low, 0.02);
    return [low === base ? low : low - margin, high + margin];
  }

  draw() {
    const width = this.element.clientWidth,
      height = this.element.clientHeight,
      ratio = window.devicePixelRatio;
    if (width === 0 || height === 0) return;
    this.width = width;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    const context = this.canvas.getContext('2d');
    context.scale(ratio, ratio);
    const style = getComputedStyle(document.documentElement);
    const [low, high] = this.range();
    const y = (value) => height - PAD - ((value - low) / (high - low)) * (height - 2 * PAD);
    const x = (time) => (this.player.duration > 0 ? time / this.player.duration : 0) * width;
    this.drawLimits(context, style, y, width, height);
    if (low < 0 && high > 0) {
      context.fillStyle = style.getPropertyValue('--line');
      context.fillRect(0, y(0), width, 1);
    }
    context.lineWidth = 1.5;
    context.lineJoin = 'round';
    for (const { values, frameTime, colour } of this.series) {
      context.strokeStyle = colour;
      context.beginPath();
      for (let i = 0; i < values.length; ++i) context.lineTo(x(i * frameTime), y(values[i]));
      context.stroke();
    }
    context.fillStyle = style.getPropertyValue('--soft');
    context.font = '10.5px system-ui, sans-serif';
    context.textBaseline = 'top';
    context.fillText(high.toFixed(2), 4, 2);
    context.textBaseline = 'bottom';
    context.fillText(low.toFixed(2), 4, height - 2);
    this.showTime();
  }

  drawLimits(context, style, y, width, height) {
    const { lower, upper } = this.limits;
    context.fillStyle = style.getPropertyValue('--shade');
    if (upper !== null) context.fillRect(0, 0, width, Math.max(0, y(upper)));
    if (lower !== null) context.fillRect(0, Math.min(height, y(lower)), width, height);
    context.strokeStyle = style.getPropertyValue('--limit');
    context.setLineDash([4, 3]);
    context.lineWidth = 1;
    for (const limit of [lower, upper]) {
      if (limit === null || y(limit) < 0 || y(limit) > height) continue;
      context.beginPath();
      context.moveTo(0, y(limit));
      context.lineTo(width, y(limit));
      context.stroke();
    }
    context.setLineDash([]);
  }

  showTime() {
    const { time, duration } = this.player;
    const share = duration > 0 ? Math.min(1, time / duration) : 0;
    this.cursor.style.transform = `translateX(${share * (this.width ?? 0) - 0.75}px)`;
  }

  close() {
    this.observer.disconnect();
    this.element.remove();
  }
}
