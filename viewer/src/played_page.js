import { byId } from './dom.js';
import { Player } from './player.js';
import { Stage } from './stage.js';
import { calm } from './theme.js';

/** The time in a link: `#t=12.3`. @returns {number|null} seconds */
function linkedTime() {
  const found = /(?:^#|[#&])t=(\d+(?:\.\d+)?)/.exec(window.location.hash);
  return found ? Number(found[1]) : null;
}

/** Base class of pages with a player: the player, the stage, and redrawing. */
export class PlayedPage {
  /** @param {number} duration  seconds  @param {number} frameTime  duration of a step, seconds */
  constructor(duration, frameTime) {
    this.player = new Player(duration, frameTime);
    this.scheduled = false;
    this.redraw = () => this.schedule();
    this.stage = new Stage(byId('canvas'), this.redraw);
    this.player.addEventListener('time', this.redraw);
    this.player.addEventListener('state', this.redraw);
  }

  /** Updates the figures to the player's time. */
  update() {}

  /** Moves the name tags to the figures' positions in the picture. */
  updateTags() {}

  /** Keys common to all pages. @param {import('./transport.js').Transport} transport */
  playerKeys(transport) {
    const { player } = this;
    const skip = (sign) => (event) => player.seek(player.time + sign * (event.shiftKey ? 0.1 : 1));
    return {
      ' ': () => player.toggle(),
      k: () => player.toggle(),
      ArrowLeft: skip(-1),
      ArrowRight: skip(1),
      ',': () => player.step(-1),
      '.': () => player.step(1),
      Home: () => player.seek(player.begin),
      End: () => player.seek(player.end),
      '-': () => transport.changeSpeed(-1),
      '+': () => transport.changeSpeed(1),
      '=': () => transport.changeSpeed(1),
      i: () => transport.markBegin(),
      o: () => transport.markEnd(),
      x: () => player.setRange(0, 0),
      l: () => player.setLooping(!player.looping),
    };
  }

  start() {
    const linked = linkedTime();
    this.player.seek(linked ?? 0);
    window.addEventListener('hashchange', () => {
      const time = linkedTime();
      if (time === null) return;
      this.player.pause();
      this.player.seek(time);
    });
    // Do not start if a link selects a time or the user prefers reduced motion.
    if (linked === null && !calm.matches && this.player.duration > 0) this.player.play();
    this.redraw();
  }

  schedule() {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame((now) => this.frame(now));
  }

  frame(now) {
    this.scheduled = false;
    this.player.advance(now);
    const passed = this.lastFrame === undefined ? 0 : Math.min(0.1, (now - this.lastFrame) / 1000);
    this.lastFrame = now;
    this.update();
    this.stage.turn(passed);
    this.stage.render();
    this.updateTags();
    if (this.player.playing || this.stage.turns) this.schedule();
  }
}
