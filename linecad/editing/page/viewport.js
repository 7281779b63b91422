// Where the photo lies on the screen: zoom at a point, pan, fit. Screen lengths are CSS px from the stage's corner.

const LARGEST_SCALE = 64; // CSS px that a pixel of the photo may fill
const SMALLEST_SHARE = 0.25; // of the scale at which all of the photo is seen
const MARGIN = 12; // CSS px around the photo when it is fitted

/** A scale and a shift. Pixels are OpenCV's: the centre of the first one is (0, 0), so its corner is (-0.5, -0.5). */
export class Viewport {
  scale = 1; // CSS px a photo pixel
  x = 0; // CSS px, where the corner of the photo is
  y = 0;
  width = 1; // CSS px, of the stage
  height = 1;

  constructor(photoWidth, photoHeight) {
    this.photoWidth = photoWidth;
    this.photoHeight = photoHeight;
  }

  toScreen([u, v]) {
    return [(u + 0.5) * this.scale + this.x, (v + 0.5) * this.scale + this.y];
  }

  toPhoto([x, y]) {
    return [(x - this.x) / this.scale - 0.5, (y - this.y) / this.scale - 0.5];
  }

  /** The part of the photo that is seen, grown by a margin in CSS px: [left, top, right, bottom] in px of the photo. */
  seen(margin = 0) {
    return [...this.toPhoto([-margin, -margin]), ...this.toPhoto([this.width + margin, this.height + margin])];
  }

  get fittingScale() {
    const room = [this.width - 2 * MARGIN, this.height - 2 * MARGIN].map((length) => Math.max(length, 1));
    return Math.min(room[0] / this.photoWidth, room[1] / this.photoHeight);
  }

  /** A scale within what makes sense for this photo and stage. */
  allowed(scale) {
    return Math.min(Math.max(scale, SMALLEST_SHARE * this.fittingScale), LARGEST_SCALE);
  }

  /** Zoom by a factor; the point under `at` stays where it is. */
  zoom(factor, at = [this.width / 2, this.height / 2]) {
    const scale = this.allowed(this.scale * factor);
    const kept = scale / this.scale;
    this.x = at[0] - (at[0] - this.x) * kept;
    this.y = at[1] - (at[1] - this.y) * kept;
    this.scale = scale;
    this.keepNear();
  }

  pan(dx, dy) {
    this.x += dx;
    this.y += dy;
    this.keepNear();
  }

  /** The photo never leaves the stage altogether: its edge goes no farther than the middle. */
  keepNear() {
    const [middleX, middleY] = [this.width / 2, this.height / 2];
    this.x = Math.min(Math.max(this.x, middleX - this.photoWidth * this.scale), middleX);
    this.y = Math.min(Math.max(this.y, middleY - this.photoHeight * this.scale), middleY);
  }

  fit() {
    this.centre([(this.photoWidth - 1) / 2, (this.photoHeight - 1) / 2], this.fittingScale);
  }

  /** Show a pixel in the middle, at a scale or the one that it has. */
  centre([u, v], scale = this.scale) {
    this.scale = this.allowed(scale);
    this.x = this.width / 2 - (u + 0.5) * this.scale;
    this.y = this.height / 2 - (v + 0.5) * this.scale;
  }

  /** Another size of the stage; what was in the middle stays there. */
  resize(width, height) {
    const middle = this.toPhoto([this.width / 2, this.height / 2]);
    this.width = width;
    this.height = height;
    this.centre(middle);
  }
}
