// Wheels, trackpads and fingers: which of them zoom and which of them move the photo.

const WHEEL_RATE = 0.0016; // log of the scale a CSS px of wheel
const PINCH_RATE = 0.01; // a pinch on a touch pad comes as a wheel with Ctrl
const LINE_HEIGHT = 18; // CSS px, for wheels that count in lines
const NOTCH = 30; // CSS px; a wheel turns by more at once, a trackpad begins with less
const PAUSE_MS = 250; // between two gestures

/** CSS px that a wheel turned in both directions, whatever unit its event counts in. */
function turned(event) {
  const unit = [1, LINE_HEIGHT, 400][event.deltaMode];
  return [event.deltaX * unit, event.deltaY * unit];
}

/** The factor by which a wheel event zooms. */
export function wheelFactor(event) {
  return Math.exp(-turned(event)[1] * (event.ctrlKey ? PINCH_RATE : WHEEL_RATE));
}

/** Tells wheels that zoom from wheels and trackpads that move; a gesture stays what it began as. */
export class Wheel {
  #last = -Infinity;
  #moves = false;

  /** How far, CSS px, an event moves the photo, or null where it zooms. */
  move(event) {
    if (event.ctrlKey) return null;
    const [x, y] = turned(event);
    const goesOn = event.timeStamp - this.#last < PAUSE_MS;
    this.#last = event.timeStamp;
    if (event.shiftKey) return [-(x || y), 0];
    const isTrackpad = event.deltaMode === 0 && Math.abs(y) < NOTCH;
    this.#moves = x !== 0 || (goesOn ? this.#moves : isTrackpad);
    return this.#moves ? [-x, -y] : null;
  }
}

/** Fingers on the photo: two of them move it and zoom. */
export class Fingers {
  #at = new Map(); // by the id of the pointer, CSS px

  get count() {
    return this.#at.size;
  }

  down(event, at) {
    if (event.pointerType === "touch") this.#at.set(event.pointerId, at);
  }

  up(event) {
    this.#at.delete(event.pointerId);
  }

  /** What a finger's move does to a viewport, where two are down. */
  move(event, at, photo) {
    if (!this.#at.has(event.pointerId)) return;
    const before = this.#span();
    this.#at.set(event.pointerId, at);
    if (this.count !== 2) return;
    const now = this.#span();
    photo.change((viewport) => {
      viewport.pan(now.middle[0] - before.middle[0], now.middle[1] - before.middle[1]);
      if (before.length > 0 && now.length > 0) viewport.zoom(now.length / before.length, now.middle);
    });
  }

  #span() {
    const [[a, b], [c, d] = [a, b]] = [...this.#at.values()];
    return { middle: [(a + c) / 2, (b + d) / 2], length: Math.hypot(c - a, d - b) };
  }
}
