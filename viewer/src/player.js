/** Playback state: time, speed and loop. Notifies listeners; is independent of what is shown. */
export class Player extends EventTarget {
  /** @param {number} duration  seconds  @param {number} frameTime  duration of a step, seconds */
  constructor(duration, frameTime) {
    super();
    this.duration = duration;
    this.frameTime = frameTime;
    this.time = 0;
    this.playing = false;
    this.speed = 1;
    this.looping = true;
    this.begin = 0;
    this.end = duration;
    // Timestamp of the previous advance(); null before the first one.
    this.last = null;
  }

  changed(what) {
    this.dispatchEvent(new Event(what));
  }

  seek(time) {
    this.time = Math.min(this.duration, Math.max(0, time));
    this.changed('time');
  }

  /** Seeks to the start of a frame. */
  seekFrame(frame) {
    this.seek(Math.round(frame) * this.frameTime);
  }

  get frame() {
    return Math.floor(this.time / this.frameTime + 1e-6);
  }

  /** Moves by a number of frames and pauses. */
  step(frames) {
    this.pause();
    this.seekFrame(this.frame + frames);
  }

  play() {
    // At the end or outside the looped range, restart from its beginning.
    if (this.time >= this.end - 1e-9 || this.time < this.begin) this.seek(this.begin);
    this.playing = true;
    this.last = null;
    this.changed('state');
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.changed('state');
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  setSpeed(speed) {
    this.speed = Math.min(4, Math.max(0.1, speed));
    this.changed('state');
  }

  setLooping(looping) {
    this.looping = looping;
    this.changed('state');
  }

  /** Sets the played range; an empty range selects everything. */
  setRange(begin, end) {
    [this.begin, this.end] = begin < end ? [begin, end] : [0, this.duration];
    this.changed('state');
  }

  /** @param {number} now  timestamp of requestAnimationFrame, milliseconds */
  advance(now) {
    if (!this.playing) return;
    const passed = this.last === null ? 0 : Math.min(250, now - this.last);
    this.last = now;
    let time = this.time + (passed / 1000) * this.speed;
    // The last frame is shown for as long as the others.
    const end = this.end + this.frameTime;
    if (time >= end) {
      if (!this.looping) {
        this.pause();
        this.seek(this.end);
        return;
      }
      const length = end - this.begin;
      time = this.begin + ((time - this.begin) % length);
    }
    this.time = time;
    this.changed('time');
  }
}
