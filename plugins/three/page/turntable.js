// Time: the turntable, and how many samples a frame has time for.

/** Degrees per second: slow enough to follow a highlight. */
const SPEED = 6;
/** Milliseconds between frames. Faster machines take more samples, and slower ones fewer. */
const [FAST, SLOW] = [24, 60];
/** Most samples per frame. */
const MOST = 32;

export class Turntable {
  isTurning = false;
  /** Of the subject, in degrees. */
  angle = 0;
  /** Samples of the truth that a frame has time for. */
  samples = 1;
  #last = null;

  /** Advances to a time in milliseconds. */
  advance(now) {
    const passed = this.#last === null ? null : now - this.#last;
    this.#last = now;
    if (passed === null) return;
    if (passed < FAST) this.samples = Math.min(2 * this.samples, MOST);
    else if (passed > SLOW) this.samples = Math.max(this.samples / 2, 1);
    // After a long pause, such as that of a hidden page, the subject must not jump.
    if (this.isTurning) this.angle = (this.angle + (SPEED * Math.min(passed, 100)) / 1000) % 360;
  }

  /** Forgets the time of the last frame, because no frame follows directly. */
  rest() {
    this.#last = null;
  }
}
