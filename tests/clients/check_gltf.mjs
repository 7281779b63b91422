// Judge a GLB by Khronos's validator, and compare what is in it with what is expected:
// GLTF_VALIDATOR=.../gltf-validator/index.js node check_gltf.mjs FILE.glb EXPECTATION.json

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { readAccessor, readGlb, transform, walkNodes } from "./glb.mjs";

const TOLERANCE = 1e-4; // m; glTF stores points as float32
const AREA_TOLERANCE = 1e-4; // m2, and share
const PIXEL_TOLERANCE = 0.05; // px
const COLOUR_TOLERANCE = 1e-4; // of 1, linear
const MOST_SHOWN = 40;
const LINES = 1, TRIANGLES = 4; // primitive.mode
const WARNING = 1; // severity of the validator; 0 is an error, larger numbers only tell
const SIZES = ["width", "height", "padded_width", "padded_height", "pad_left", "pad_top", "fx", "fy", "cx", "cy"];

const problems = [];
const need = (holds, problem) => {
  if (!holds) problems.push(problem);
  return Boolean(holds);
};

/** Note all problems of the file; returns a summary. */
async function check(path, expected) {
  const bytes = readFileSync(path);
  const validator = createRequire(import.meta.url)(process.env.GLTF_VALIDATOR ?? "gltf-validator");
  const { issues } = await validator.validateBytes(new Uint8Array(bytes), { uri: path, maxIssues: 0 });
  for (const { severity, code, pointer, message } of issues.messages) {
    need(severity > WARNING, `the validator says ${code} at ${pointer}: ${message}`);
  }
  const file = readGlb(bytes);
  const nodes = walkNodes(file.tree);
  const meshes = nodes.filter(({ node }) => node.mesh !== undefined);
  const isLines = ({ node }) => file.tree.meshes[node.mesh].primitives[0].mode === LINES;
  checkNames("nodes of lines", meshes.filter(isLines), Object.keys(expected.groups));
  checkNames("nodes of faces", meshes.filter((mesh) => !isLines(mesh)), expected.faces.map(({ name }) => name));
  const placed = new Map();
  const faces = new Map(expected.faces.map((face) => [face.name, face]));
  for (const { node, matrix } of meshes) {
    const { primitives, extras } = file.tree.meshes[node.mesh];
    if (!need(primitives.length === 1, `${node.name}: ${primitives.length} primitives, expected 1`)) continue;
    const group = expected.groups[node.name];
    const face = faces.get(node.name);
    if (group) checkLines(file, node.name, primitives[0], extras, matrix, expected, placed);
    if (face) {
      const told = [node.extras?.label, node.extras?.kind, node.extras?.opening ?? null];
      const wanted = [face.label, face.kind, face.opening];
      need(String(told) === String(wanted), `${face.name} says ${told}, expected ${wanted}`);
      const opening = expected.openings.find(({ id }) => id === face.opening);
      const shown = file.tree.meshes[node.mesh].name; // equal faces may share a mesh
      need([face.label, `${face.kind} of shape ${opening?.shape}`].includes(shown), `${face.name} shows a ${shown}`);
      checkFace(file, face, primitives[0], matrix);
    }
  }
  for (const opening of expected.openings) checkOpening(file.tree, opening);
  const largest = checkCamera(file.tree, nodes, expected, placed);
  const counts = `${issues.numErrors} errors, ${issues.numWarnings} warnings`;
  const pixels = `lines at most ${largest.toFixed(5)} px off`;
  const shown = `${placed.size} lines, ${meshes.filter((mesh) => !isLines(mesh)).length} faces`;
  return `glTF validator ${validator.version()}: ${counts}; ${shown}, ${pixels}`;
}

/** From glTF's frame, y up, to the scene's, z up. */
const upright = ([x, y, z]) => [x, -z, y];

const pointsOf = (file, primitive, matrix) =>
  readAccessor(file, primitive.attributes.POSITION).map((point) => upright(transform(matrix, point)));

const indicesOf = (file, primitive, count) =>
  primitive.indices === undefined ? [...Array(count).keys()] : readAccessor(file, primitive.indices).flat();

const apart = (a, b) => Math.max(...a.map((value, index) => Math.abs(value - b[index])));
const dot = (a, b) => a.reduce((sum, value, index) => sum + value * b[index], 0);
const minus = (a, b) => a.map((value, index) => value - b[index]);
const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];
const near = (a, b, tolerance) => a.length === b.length && apart(a, b) <= tolerance;

function checkNames(kind, found, wanted) {
  const names = found.map(({ node }) => node.name);
  const missing = wanted.filter((name) => !names.includes(name));
  need(!missing.length, `${kind}: ${missing.length} are missing, such as ${missing.slice(0, 3)}`);
  const more = names.filter((name, index) => !wanted.includes(name) || names.indexOf(name) < index);
  need(!more.length, `${kind}: ${more.length} are not expected or twice, such as ${more.slice(0, 3)}`);
}

/** An opening is a node above its faces. */
function checkOpening(tree, { id, shape, kind, label, faces }) {
  const node = tree.nodes.find(({ name }) => name === label);
  if (!need(node, `there is no node for ${label}`)) return;
  const told = ["opening", "shape", "kind", "label"].map((key) => node.extras?.[key]);
  need(String(told) === String([id, shape, kind, label]), `${label} says ${told}`);
  const children = (node.children ?? []).map((child) => tree.nodes[child].name).sort();
  need(String(children) === String([...faces].sort()), `${label} has ${children}, expected ${faces}`);
}

/** The lines of a group, which stand in ascending id; those in their place are added to `placed`, by id. */
function checkLines(file, name, primitive, extras, matrix, expected, placed) {
  const group = expected.groups[name];
  const points = pointsOf(file, primitive, matrix);
  const indices = indicesOf(file, primitive, points.length);
  const wanted = expected.lines.filter((line) => line.group === name);
  need(indices.length === 2 * wanted.length, `${name}: ${indices.length / 2} lines, expected ${wanted.length}`);
  wanted.slice(0, indices.length / 2).forEach((line, index) => {
    const [start, end] = [points[indices[2 * index]], points[indices[2 * index + 1]]];
    const [a, b] = line.ends;
    const same = Math.max(apart(start, a), apart(end, b));
    const turned = Math.max(apart(start, b), apart(end, a));
    if (need(Math.min(same, turned) <= TOLERANCE, `line ${line.id} is ${Math.min(same, turned)} m from its place`)) {
      placed.set(line.id, same <= turned ? [start, end] : [end, start]);
    }
  });
  const told = extras ?? {};
  const right = told.axis === group.axis && told.boundary === group.boundary;
  need(right, `${name} says axis ${told.axis}, boundary ${told.boundary}`);
  need(String(told.line_ids) === String(group.ids), `${name} says the ids ${told.line_ids}, expected ${group.ids}`);
  need(String(told.roles) === String(group.roles), `${name} says the roles ${told.roles}, expected ${group.roles}`);
  if (primitive.attributes._LINEID !== undefined) {
    const ids = indices.map((index) => readAccessor(file, primitive.attributes._LINEID)[index][0]);
    need(String(ids) === String(group.ids.flatMap((id) => [id, id])), `${name}: _LINEID does not tell the ids`);
  }
  const material = file.tree.materials?.[primitive.material];
  if (need(material, `${name} has no material`)) {
    need(material.extensions?.KHR_materials_unlit, `${name} is lit, though a line has no normal`);
    checkColour(name, material, group.linear);
  }
}

function checkColour(name, material, wanted) {
  const colour = material.pbrMetallicRoughness?.baseColorFactor ?? [1, 1, 1, 1];
  need(near(colour, [...wanted, 1], COLOUR_TOLERANCE), `${name}: colour ${colour}, expected ${wanted}`);
}

/** The triangles must use every corner, have the rings as their border and their area, and look where the face does. */
function checkFace(file, face, primitive, matrix) {
  const { name, corners, rings } = face;
  need((primitive.mode ?? TRIANGLES) === TRIANGLES, `${name} is of mode ${primitive.mode}, expected triangles`);
  const points = pointsOf(file, primitive, matrix);
  const indices = indicesOf(file, primitive, points.length);
  const corner = indices.map((index) => nearest(points[index], corners));
  const off = Math.max(...indices.map((index, at) => apart(points[index], corners[corner[at]])));
  need(off <= TOLERANCE, `${name}: a vertex is ${off} m from the nearest corner`);
  const unused = corners.length - new Set(corner).size;
  need(!unused, `${name}: ${unused} of ${corners.length} corners are in no triangle, as at a crack`);
  const edges = new Set();
  let area = 0, away = 0;
  for (let at = 0; at < indices.length; at += 3) {
    const [a, b, c] = [0, 1, 2].map((step) => points[indices[at + step]]);
    const normal = cross(minus(b, a), minus(c, a));
    area += Math.hypot(...normal) / 2;
    away += dot(normal, face.normal) <= 0;
    for (const step of [0, 1, 2]) edges.add(`${corner[at + step]} ${corner[at + ((step + 1) % 3)]}`);
  }
  need(edges.size === indices.length, `${name}: neighbouring triangles are turned differently`);
  const turned = (edge) => edge.split(" ").reverse().join(" ");
  const border = [...edges].filter((edge) => !edges.has(turned(edge)));
  const wanted = rings.flatMap((ring) => ring.map((from, at) => `${from} ${ring[(at + 1) % ring.length]}`));
  const lost = wanted.filter((edge) => !border.includes(edge) && !border.includes(turned(edge)));
  need(!lost.length, `${name}: ${lost.length} of ${wanted.length} edges of its rings do not bound the triangles`);
  need(border.length === wanted.length, `${name}: ${border.length} edges bound it, expected ${wanted.length}`);
  const right = Math.abs(area - face.area) <= AREA_TOLERANCE * Math.max(1, face.area);
  need(right, `${name}: area ${area} m2, expected ${face.area}`);
  need(!away, `${name}: ${away} triangles are turned away from where it is seen`);
  checkSurface(file, face, primitive);
}

const nearest = (point, corners) => {
  const distances = corners.map((corner) => apart(point, corner));
  return distances.indexOf(Math.min(...distances));
};

function checkSurface({ tree }, { name, linear }, primitive) {
  const material = tree.materials?.[primitive.material];
  if (!need(material, `${name} has no material`)) return;
  need(material.doubleSided, `${name} is seen from one side only`);
  need(primitive.attributes.NORMAL !== undefined, `${name} has no normals`);
  const texture = material.pbrMetallicRoughness?.baseColorTexture;
  if (texture === undefined) {
    checkColour(name, material, linear);
    return;
  }
  need(primitive.attributes.TEXCOORD_0 !== undefined, `${name} has a picture and no texture coordinates`);
  const image = tree.images?.[tree.textures?.[texture.index]?.source];
  need(image?.bufferView !== undefined, `${name}: its picture is not in the file`);
}

/** Look at the lines through the camera; returns the largest distance from the photo in px. */
function checkCamera(tree, nodes, expected, placed) {
  const cameras = nodes.filter(({ node }) => node.camera !== undefined);
  if (!need(cameras.length === 1, `${cameras.length} cameras, expected 1`)) return NaN;
  const [{ node, matrix }] = cameras;
  const { perspective, extras } = tree.cameras[node.camera];
  const { width, height, left, top } = expected.frame;
  const { focal, principal_point: [cx, cy], rotation, width: photoWidth, height: photoHeight } = expected.camera;
  const wanted = [photoWidth, photoHeight, width, height, left, top, focal, focal, cx, cy];
  for (const [owner, told] of [["camera", extras], ["node", node.extras]]) {
    const values = SIZES.map((key) => told?.[`linecad_${key}`] ?? NaN);
    need(near(values, wanted, 1e-9 * width), `the extras of the ${owner} say ${values}, expected ${wanted}`);
  }
  const square = Math.abs(perspective.aspectRatio * height / width - 1) < 1e-9;
  need(square, `aspectRatio is ${perspective.aspectRatio}, expected ${width} / ${height}`);
  const seen = height / 2 / Math.tan(perspective.yfov / 2); // focal length, px
  const columns = [0, 1, 2].map((column) => matrix.slice(4 * column, 4 * column + 3));
  const axes = columns.map(upright);
  const place = upright(matrix.slice(12, 15));
  let largest = 0;
  for (const line of expected.lines) {
    (placed.get(line.id) ?? []).forEach((point, end) => {
      const [x, y, z] = axes.map((axis) => dot(axis, minus(point, place))); // it looks along -z, y up
      const { znear, zfar } = perspective;
      need(-z > znear && -z < zfar, `line ${line.id}, ${-z} m away, is clipped at ${znear} and ${zfar} m`);
      const across = (seen * x) / -z * (width / height / perspective.aspectRatio);
      const pixel = [width / 2 - left + across, height / 2 - top + (seen * y) / z];
      largest = Math.max(largest, Math.hypot(...minus(pixel, line.pixels[end])));
    });
  }
  need(placed.size > 0, "no line could be looked at through the camera");
  need(largest <= PIXEL_TOLERANCE, `lines end ${largest} px from their place in the photo, allowed ${PIXEL_TOLERANCE}`);
  need(dot(axes[2], rotation[2]) < 0, "the camera looks away from the scene");
  return largest;
}

let summary = "";
try {
  const [path, expectation] = process.argv.slice(2);
  summary = await check(path, JSON.parse(readFileSync(expectation, "utf8")));
} catch (error) {
  problems.push(`${error.name}: ${error.message.split("\n")[0]}`);
}
for (const problem of problems.slice(0, MOST_SHOWN)) console.log(`  - ${problem}`);
const failed = `CHECK FAILED: ${problems.length} problem${problems.length > 1 ? "s" : ""}; first: ${problems[0]}`;
console.log(problems.length ? `${failed} [${summary}]` : `CHECK OK ${summary}`);
process.exitCode = problems.length ? 1 : 0;
