// The face under a place of a stage: the nearest of all triangles that are seen there.

/** Triangles of all faces as corners [x, y, nearness]; `project` gives such a corner, or null behind the eye. */
export function seenTriangles(planes, project) {
  const found = [];
  for (const plane of planes) {
    for (const face of plane.faces ?? []) {
      const corners = [face.outline, ...(face.holes ?? [])].flat().map(project);
      for (const triangle of face.triangles) {
        const own = triangle.map((index) => corners[index]);
        if (!own.includes(null)) found.push({ corners: own, face, plane });
      }
    }
  }
  return found;
}

/** `{face, plane}` of the nearest triangle that holds a place, or null. Nearness must be linear on the stage. */
export function faceAt(triangles, [x, y]) {
  let best = null;
  let nearest = -Infinity;
  for (const { corners, face, plane } of triangles) {
    const [[ax, ay, an], [bx, by, bn], [cx, cy, cn]] = corners;
    const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    if (area === 0) continue;
    const b = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area;
    const c = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area;
    if (b < 0 || c < 0 || b + c > 1) continue;
    const nearness = an + b * (bn - an) + c * (cn - an);
    if (nearness > nearest) [best, nearest] = [{ face, plane }, nearness];
  }
  return best;
}
