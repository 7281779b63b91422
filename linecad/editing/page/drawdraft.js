// Unfinished work over the photo: a line being drawn or stretched, with what it snaps to, a rectangle, a cross-hair.

import { AXIS, CASING, INK } from "./colours.js";
import { strokeLines } from "./drawing.js";
import { snapText } from "./proposals.js";

const WORDS_AWAY = 12; // CSS px from what they tell of

/** The lines of a tool: what the person drew, thin, over what the server would make of it. */
export function drawDraft(context, viewport, draft) {
  context.lineCap = "round";
  for (const { ends, axis } of draft.lines) strokeDraft(context, viewport, ends, axis);
  const { question, stretched } = draft;
  if (question) strokeDraft(context, viewport, question.ends, null);
  // What lies too far off every axis is asked about: until then it is shown as it was drawn.
  const proposal = draft.proposal?.is_bent && !draft.isForced ? null : draft.proposal;
  for (const made of [proposal, stretched]) if (made) strokeDraft(context, viewport, made.ends, made.axis);
  if (draft.rubber) {
    context.setLineDash([4, 4]);
    strokeLines(context, viewport, [{ segment: draft.rubber }], INK, 1);
    context.setLineDash([]);
  }
  for (const point of draft.points) knob(context, viewport.toScreen(point), INK);
  for (const made of [proposal, stretched, draft.start]) if (made) drawSnaps(context, viewport, made);
}

/** Knobs where ends snap, with words: "end of line 12". */
function drawSnaps(context, viewport, { ends, snapped, axis }) {
  ends.forEach((end, index) => {
    if (!snapped?.[index]) return;
    const at = viewport.toScreen(end);
    knob(context, at, AXIS[axis] ?? INK);
    words(context, viewport, at, snapText(snapped[index]));
  });
}

function words(context, viewport, [x, y], text) {
  context.font = "12px system-ui, sans-serif";
  const width = context.measureText(text).width;
  const left = x + WORDS_AWAY + width > viewport.width ? x - WORDS_AWAY - width : x + WORDS_AWAY;
  const base = y - WORDS_AWAY < 14 ? y + WORDS_AWAY + 10 : y - WORDS_AWAY;
  context.lineJoin = "round";
  context.lineWidth = 4;
  context.strokeStyle = CASING;
  context.strokeText(text, left, base);
  context.fillStyle = INK;
  context.fillText(text, left, base);
}

function strokeDraft(context, viewport, ends, axis) {
  strokeLines(context, viewport, [{ segment: ends }], CASING, 5.5);
  strokeLines(context, viewport, [{ segment: ends }], AXIS[axis] ?? INK, 3);
}

export function knob(context, [x, y], colour) {
  context.beginPath();
  context.arc(x, y, 4.5, 0, 2 * Math.PI);
  context.fillStyle = CASING;
  context.fill();
  context.lineWidth = 2;
  context.strokeStyle = colour;
  context.stroke();
}

/** The rectangle that selects what it holds, between two pixels. */
export function drawMarquee(context, viewport, [from, to]) {
  const [[a, b], [c, d]] = [viewport.toScreen(from), viewport.toScreen(to)];
  context.globalAlpha = 0.12;
  context.fillStyle = INK;
  context.fillRect(a, b, c - a, d - b);
  context.globalAlpha = 1;
  context.lineWidth = 1;
  for (const [dashes, ink] of [
    [[], CASING],
    [[5, 4], INK],
  ]) {
    context.setLineDash(dashes);
    context.strokeStyle = ink;
    context.strokeRect(a, b, c - a, d - b);
  }
  context.setLineDash([]);
}

/** The pointer of the keyboard, open in the middle so that one sees what it points at. */
export function drawCrosshair(context, viewport, [x, y]) {
  const gap = 7;
  for (const [width, ink] of [
    [3, CASING],
    [1, INK],
  ]) {
    context.lineWidth = width;
    context.strokeStyle = ink;
    context.beginPath();
    for (const [a, b, c, d] of [
      [0, y, x - gap, y],
      [x + gap, y, viewport.width, y],
      [x, 0, x, y - gap],
      [x, y + gap, x, viewport.height],
    ]) {
      context.moveTo(a, b);
      context.lineTo(c, d);
    }
    context.stroke();
  }
}
