// The three axes as they lie in the view of the model.

import { AXIS } from "./colours.js";

const SIDE = 72; // CSS px

/** Draw on a canvas the axes for a view with such `axes`: right, up and back in the world. */
export function paintGizmo(canvas, axes) {
  canvas.width = canvas.height = SIDE * devicePixelRatio;
  const context = canvas.getContext("2d");
  context.scale(devicePixelRatio, devicePixelRatio);
  context.translate(SIDE / 2, SIDE / 2);
  context.font = "600 12px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineWidth = 2.4;
  context.lineCap = "round";
  const arms = ["x", "y", "z"].map((name, axis) => [name, axes.map((direction) => direction[axis])]);
  for (const [name, [right, up]] of arms.sort((a, b) => a[1][2] - b[1][2])) {
    context.strokeStyle = context.fillStyle = AXIS[name];
    context.beginPath();
    context.moveTo(0, 0);
    context.lineTo(22 * right, -22 * up);
    context.stroke();
    context.fillText(name, 29 * right, -29 * up);
  }
}
