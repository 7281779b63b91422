// The names of axes: x, y and z of the main frame, x2 and y2 of the first further frame, and so on; z is of all.

/** x, y or z: the axis within its frame. */
export function letterOf(axis) {
  return axis[0];
}

/** The frame of an axis, 1 for the main one. */
export function frameOf(axis) {
  return axis.length > 1 ? Number(axis.slice(1)) : 1;
}

/** The same axis of the next of all frames, of the main one after the last; z stays. */
export function inNextFrame(axis, frames) {
  const letter = letterOf(axis);
  const next = (frameOf(axis) % frames) + 1;
  return letter === "z" || next === 1 ? letter : `${letter}${next}`;
}
