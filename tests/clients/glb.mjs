// Reads a GLB file by the specification: its document, the numbers in its accessors, and its nodes in the world.

const MAGIC = 0x46546c67, JSON_CHUNK = 0x4e4f534a, BINARY_CHUNK = 0x004e4942;
const HEADER = 12, CHUNK_HEADER = 8; // bytes
const COMPONENTS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const READERS = {
  5121: [1, "readUInt8"],
  5123: [2, "readUInt16LE"],
  5125: [4, "readUInt32LE"],
  5126: [4, "readFloatLE"],
};
const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** The document of a GLB, a dictionary, and its binary chunk. */
export function readGlb(bytes) {
  if (bytes.readUInt32LE(0) !== MAGIC || bytes.readUInt32LE(8) !== bytes.length) {
    throw new Error("this is no whole GLB file");
  }
  const chunks = new Map();
  for (let at = HEADER; at < bytes.length; ) {
    const length = bytes.readUInt32LE(at);
    const begin = at + CHUNK_HEADER;
    chunks.set(bytes.readUInt32LE(at + 4), bytes.subarray(begin, begin + length));
    at = begin + length;
  }
  return { tree: JSON.parse(chunks.get(JSON_CHUNK).toString("utf8")), binary: chunks.get(BINARY_CHUNK) };
}

/** The values of an accessor, an array of numbers each. */
export function readAccessor({ tree, binary }, index) {
  const accessor = tree.accessors[index];
  const view = tree.bufferViews[accessor.bufferView];
  const [size, read] = READERS[accessor.componentType];
  const count = COMPONENTS[accessor.type];
  const begin = (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
  const stride = view.byteStride ?? count * size;
  const component = (row, column) => binary[read](begin + row * stride + column * size);
  return Array.from({ length: accessor.count }, (_, row) =>
    Array.from({ length: count }, (_, column) => component(row, column)),
  );
}

/** Every node of the scene with its matrix to the world, 16 numbers by columns. */
export function walkNodes(tree) {
  const found = [];
  const visit = (index, parent) => {
    const node = tree.nodes[index];
    const matrix = multiply(parent, localMatrix(node));
    found.push({ node, matrix });
    for (const child of node.children ?? []) visit(child, matrix);
  };
  for (const root of tree.scenes[tree.scene ?? 0].nodes) visit(root, IDENTITY);
  return found;
}

/** A point, moved by a matrix. */
export function transform(matrix, point) {
  return [0, 1, 2].map(
    (row) => matrix[row] * point[0] + matrix[4 + row] * point[1] + matrix[8 + row] * point[2] + matrix[12 + row],
  );
}

function localMatrix(node) {
  if (node.matrix) return node.matrix;
  if (node.rotation || node.scale) {
    throw new Error(`node ${node.name} has a rotation or scale, where linecad writes matrices`);
  }
  return [...IDENTITY.slice(0, 12), ...(node.translation ?? [0, 0, 0]), 1];
}

function multiply(a, b) {
  const entry = (row, column) => [0, 1, 2, 3].reduce((sum, k) => sum + a[4 * k + row] * b[4 * column + k], 0);
  return IDENTITY.map((_, index) => entry(index % 4, Math.floor(index / 4)));
}
