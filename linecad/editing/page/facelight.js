// The selected face over the photo: all faces of its plane, filled, and outlined twice so that they show on anything.

import { CASING, INK } from "./colours.js";
import { tracePolygon } from "./drawing.js";
import { product } from "./matrices.js";

const FILL = "#22222a33";

/** Draw in a context in CSS px of the stage. */
export function drawSelectedPlane(context, store, viewport) {
  if (store.selection?.kind !== "face") return;
  const { K, R_cam_from_world: rotation, photo } = store.state;
  const project = product(K, rotation);
  context.save();
  context.beginPath();
  context.rect(viewport.x, viewport.y, photo.width * viewport.scale, photo.height * viewport.scale);
  context.clip();
  for (const face of store.find(store.selection).plane.faces) {
    if (!store.showsFace(face)) continue;
    context.beginPath();
    for (const ring of [face.outline, ...face.holes]) tracePolygon(context, ring, project, viewport);
    context.fillStyle = FILL;
    context.fill("evenodd");
    for (const [ink, width] of [
      [CASING, 4.2],
      [INK, 1.8],
    ]) {
      context.strokeStyle = ink;
      context.lineWidth = width;
      context.stroke();
    }
  }
  context.restore();
}
