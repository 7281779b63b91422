// The photo in tiles by level: those that are seen are asked for, the latest first, and kept while there is room.

const AT_ONCE = 6; // requests under way
const KEPT = 160; // tiles, about 1 MiB each

/** The tiles of one photo. `onArrival` is called when one has come that was missing. */
export class Tiles {
  #bitmaps = new Map(); // "level/column/row" -> ImageBitmap, the one used last at the end
  #wanted = []; // keys, the most urgent first
  #underWay = new Set();
  #failed = new Set();

  constructor(server, photo, onArrival) {
    this.server = server;
    this.photo = photo;
    this.onArrival = onArrival;
    this.coarsest = photo.levels - 1;
    this.#want([this.#key(this.coarsest, 0, 0)]);
  }

  #key(level, column, row) {
    return `${level}/${column}/${row}`;
  }

  /** Width and height of a level in its own px. */
  size(level) {
    return [Math.ceil(this.photo.width / 2 ** level), Math.ceil(this.photo.height / 2 ** level)];
  }

  /** The level whose pixels are the smallest that are not smaller than one of the screen. */
  level(devicePixelsPerPhotoPixel) {
    return Math.min(Math.max(Math.floor(-Math.log2(devicePixelsPerPhotoPixel) + 0.1), 0), this.coarsest);
  }

  /** Draw the part [left, top, right, bottom] (px of the photo, its corner is at 0, 0) in a context scaled to it. */
  draw(context, level, part) {
    const wanted = [...this.#inside(level, part)];
    const missing = wanted.map(([key]) => key).filter((key) => !this.#bitmaps.has(key));
    // The coarsest level always lies below, so that no seam between tiles lets the background through.
    const finest = missing.length > 0 ? level + 1 : this.coarsest;
    for (let coarse = this.coarsest; coarse >= finest; coarse--) this.#putAll(context, this.#inside(coarse, part));
    this.#putAll(context, wanted);
    this.#want(missing);
  }

  #putAll(context, tiles) {
    for (const [key, place] of tiles) if (this.#bitmaps.has(key)) this.#put(context, key, place);
  }

  #put(context, key, [x, y, width, height]) {
    const bitmap = this.#bitmaps.get(key);
    context.drawImage(bitmap, x, y, width, height);
    this.#bitmaps.delete(key); // and in again: now it is the one used last
    this.#bitmaps.set(key, bitmap);
  }

  /** Key and place (px of the photo) of the tiles of a level that touch a part of the photo. */
  *#inside(level, [left, top, right, bottom]) {
    const [width, height] = this.size(level);
    const [stretchX, stretchY] = [this.photo.width / width, this.photo.height / height];
    const side = this.photo.tile;
    const last = [Math.ceil(width / side) - 1, Math.ceil(height / side) - 1];
    const first = [left / stretchX / side, top / stretchY / side].map((at) => Math.max(Math.floor(at), 0));
    const end = [right / stretchX / side, bottom / stretchY / side].map((at, i) => Math.min(Math.floor(at), last[i]));
    for (let row = first[1]; row <= end[1]; row++) {
      for (let column = first[0]; column <= end[0]; column++) {
        const [x, y] = [column * side, row * side];
        const [w, h] = [Math.min(side, width - x), Math.min(side, height - y)];
        yield [this.#key(level, column, row), [x * stretchX, y * stretchY, w * stretchX, h * stretchY]];
      }
    }
  }

  /** What was wanted before and is not seen any more is not asked for. */
  #want(keys) {
    this.#wanted = keys.filter((key) => !this.#underWay.has(key) && !this.#failed.has(key));
    this.#next();
  }

  #next() {
    while (this.#underWay.size < AT_ONCE && this.#wanted.length > 0) this.#load(this.#wanted.shift());
  }

  async #load(key) {
    this.#underWay.add(key);
    try {
      this.#bitmaps.set(key, await this.server.tile(...key.split("/")));
      this.#forget();
      this.onArrival();
    } catch {
      this.#failed.add(key); // the coarser level stays in its place; a reload of the page asks again
    }
    this.#underWay.delete(key);
    this.#next();
  }

  #forget() {
    const always = this.#key(this.coarsest, 0, 0);
    for (const [key, bitmap] of this.#bitmaps) {
      if (this.#bitmaps.size <= KEPT) break;
      if (key === always) continue;
      this.#bitmaps.delete(key);
      bitmap.close();
    }
  }
}
