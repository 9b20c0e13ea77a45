import { byId, el, icon, seconds, toggle } from './dom.js';

const ICONS = {
  start: 'M3 3h2v10H3zM14 3v10L6 8z',
  back: 'M12 3v10L5 8z',
  play: 'M4 2.5v11l9-5.5z',
  pause: 'M3.5 3h3.2v10H3.5zM9.3 3h3.2v10H9.3z',
  forward: 'M4 3v10l7-5z',
  end: 'M11 3h2v10h-2zM2 3v10l8-5z',
};
const SPEEDS = [0.1, 0.25, 0.5, 1, 1.5, 2, 4];

/** The controls below the picture: play, step, speed, looped range, time. */
export class Transport {
  /** @param {import('./player.js').Player} player */
  constructor(player) {
    this.player = player;
    const button = (name, key, path, action, className) =>
      el(
        'button',
        {
          type: 'button',
          'aria-label': name,
          title: `${name} (${key})`,
          class: className,
          on: { click: action },
        },
        icon(path),
      );
    this.play = button('Play', 'space', ICONS.play, () => player.toggle(), 'play');
    this.clock = el('span', { id: 'clock' });
    this.speed = el(
      'select',
      { id: 'speed', 'aria-label': 'Speed', title: 'Speed (\u2212 and +)' },
      ...SPEEDS.map((speed) => el('option', { value: speed, text: `${speed}\u00d7` })),
    );
    this.speed.addEventListener('change', () => player.setSpeed(Number(this.speed.value)));
    this.loop = toggle(
      'Loop',
      player.looping,
      (on) => player.setLooping(on),
      'Repeat from the beginning (L)',
    );
    this.whole = el('button', {
      type: 'button',
      text: 'Whole',
      title: 'Play the whole motion (X)',
      on: { click: () => player.setRange(0, 0) },
    });
    byId('buttons').append(
      button('Go to the start', 'Home', ICONS.start, () => player.seek(player.begin)),
      button('Back one frame', ',', ICONS.back, () => player.step(-1)),
      this.play,
      button('Forward one frame', '.', ICONS.forward, () => player.step(1)),
      button('Go to the end', 'End', ICONS.end, () => player.seek(player.end)),
      this.clock,
      el('span', { class: 'push' }),
      this.loop,
      el('button', {
        type: 'button',
        text: 'From',
        title: 'Start the loop here (I)',
        on: { click: () => this.markBegin() },
      }),
      el('button', {
        type: 'button',
        text: 'To',
        title: 'End the loop here (O)',
        on: { click: () => this.markEnd() },
      }),
      this.whole,
      this.speed,
    );
    player.addEventListener('time', () => this.showTime());
    player.addEventListener('state', () => this.showState());
    this.showTime();
    this.showState();
  }

  markBegin() {
    const { player } = this;
    player.setRange(player.time, player.end > player.time ? player.end : player.duration);
  }

  markEnd() {
    const { player } = this;
    player.setRange(player.begin < player.time ? player.begin : 0, player.time);
  }

  /** Selects the next slower (-1) or faster (1) speed. */
  changeSpeed(by) {
    const now = SPEEDS.findIndex((speed) => speed >= this.player.speed - 1e-9);
    this.player.setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, now + by))]);
  }

  showTime() {
    const { player } = this;
    if (player.frame === this.shownFrame) return;
    this.shownFrame = player.frame;
    const frames = Math.round(player.duration / player.frameTime) + 1;
    const time = Math.min(player.time, player.duration);
    this.clock.replaceChildren(
      el('b', { text: time.toFixed(2) }),
      ` / ${seconds(player.duration)}  \u00b7  ${Math.min(player.frame, frames - 1)} / ${frames - 1}`,
    );
  }

  showState() {
    const { player } = this;
    const name = player.playing ? 'Pause' : 'Play';
    if (this.play.getAttribute('aria-label') !== name) {
      this.play.setAttribute('aria-label', name);
      this.play.title = `${name} (space)`;
    }
    this.play.replaceChildren(icon(player.playing ? ICONS.pause : ICONS.play));
    this.loop.setAttribute('aria-pressed', String(player.looping));
    this.speed.value = String(player.speed);
    this.whole.hidden = player.begin === 0 && player.end === player.duration;
  }
}
