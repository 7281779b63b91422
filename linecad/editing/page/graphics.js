// WebGL 2 for the model: lines of any width, faces with the photo projected on them by its own camera, points.

const LINE_VERTEX = `#version 300 es
layout(location = 0) in vec2 corner;  // -1 or 1 across the line, 0 or 1 along it
layout(location = 1) in vec3 start;
layout(location = 2) in vec3 end;
layout(location = 3) in vec4 colour;
layout(location = 4) in float width;  // device px
uniform mat4 clip_from_world;
uniform vec2 stage;  // device px
uniform float nearer;  // share of the depth by which lines stand before what they lie on
out vec4 shade;
const float NEAR = 1e-6;
void main() {
  vec4 a = clip_from_world * vec4(start, 1.0);
  vec4 b = clip_from_world * vec4(end, 1.0);
  shade = colour;
  float da = a.z + a.w - NEAR;
  float db = b.z + b.w - NEAR;
  if (da < 0.0 && db < 0.0) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
  if (da < 0.0) a = mix(a, b, da / (da - db));
  if (db < 0.0) b = mix(b, a, db / (db - da));
  vec2 along = (b.xy / b.w - a.xy / a.w) * stage;
  float span = length(along);
  vec2 direction = span > 1e-6 ? along / span : vec2(1.0, 0.0);
  vec2 across = vec2(-direction.y, direction.x);
  vec4 at = corner.y < 0.5 ? a : b;
  vec2 shift = (across * corner.x + direction * (corner.y * 2.0 - 1.0) * 0.5) * width / stage;
  at.xy += shift * at.w;
  at.z -= nearer * at.w;
  gl_Position = at;
}`;

const FLAT_FRAGMENT = `#version 300 es
precision highp float;
in vec4 shade;
out vec4 result;
void main() { result = vec4(shade.rgb * shade.a, shade.a); }`;

const FACE_VERTEX = `#version 300 es
layout(location = 0) in vec3 point;
layout(location = 1) in vec4 colour;
uniform mat4 clip_from_world;
out vec3 world;
out vec4 shade;
void main() { world = point; shade = colour; gl_Position = clip_from_world * vec4(point, 1.0); }`;

// A pixel's centre is a whole number in K, the texture begins at the corner: half a pixel between them.
const FACE_FRAGMENT = `#version 300 es
precision highp float;
const float GUESS_BELOW = 0.5;  // opacities below it mark faces whose depth is a guess
const float PALE = 0.5;
in vec3 world;
in vec4 shade;
uniform mat3 pixel_from_world;
uniform vec2 photo_size;
uniform sampler2D photo;
uniform bool textured;
uniform bool pales;  // whether guesses fade into the background; else an opacity is just that
uniform vec3 paper;  // of the background
out vec4 result;
void main() {
  vec4 colour = shade;
  vec3 seen = pixel_from_world * world;
  vec2 at = (seen.xy / seen.z + 0.5) / photo_size;
  vec3 texel = texture(photo, at).rgb;
  bool inside = seen.z > 0.0 && at == clamp(at, 0.0, 1.0);
  if (textured && inside) colour = vec4(gl_FrontFacing ? texel : mix(texel, shade.rgb, 0.35), 1.0);
  if (pales && shade.a < GUESS_BELOW) colour = vec4(mix(colour.rgb, paper, PALE), 1.0);
  result = vec4(colour.rgb * colour.a, colour.a);
}`;

const FLOATS_A_LINE = 11; // start, end, colour, width
const FLOATS_A_CORNER = 7; // point, colour

/** Draws lines and triangles in a canvas. Throws where WebGL 2 is missing. */
export class Graphics {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, premultipliedAlpha: true });
    if (!gl) throw new Error("no WebGL 2");
    this.gl = gl;
    this.largestTexture = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    this.lineProgram = program(gl, LINE_VERTEX, FLAT_FRAGMENT);
    this.faceProgram = program(gl, FACE_VERTEX, FACE_FRAGMENT);
    this.photo = null;
    this.#makeGrey();
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** One grey pixel stands for the photo until that has come. */
  #makeGrey() {
    const gl = this.gl;
    this.grey = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.grey);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 1, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array([204, 201, 189, 255]));
  }

  /** Room for a photo of so many px. */
  preparePhoto(width, height) {
    const gl = this.gl;
    this.coming = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.coming);
    gl.texStorage2D(gl.TEXTURE_2D, 1 + Math.floor(Math.log2(Math.max(width, height))), gl.RGBA8, width, height);
  }

  addTile(bitmap, x, y) {
    const gl = this.gl;
    gl.bindTexture(gl.TEXTURE_2D, this.coming);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, x, y, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
  }

  /** All tiles are there: the photo is shown from now on. */
  finishPhoto() {
    const gl = this.gl;
    gl.bindTexture(gl.TEXTURE_2D, this.coming);
    gl.generateMipmap(gl.TEXTURE_2D);
    for (const [name, value] of [
      ["MIN_FILTER", gl.LINEAR_MIPMAP_LINEAR],
      ["MAG_FILTER", gl.LINEAR],
      ["WRAP_S", gl.CLAMP_TO_EDGE],
      ["WRAP_T", gl.CLAMP_TO_EDGE],
    ]) {
      gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], value);
    }
    if (this.photo) gl.deleteTexture(this.photo);
    this.photo = this.coming;
    this.coming = null;
  }

  /** A buffer of lines `{start, end, colour: [r, g, b, a], width}`; `before` is what it replaces. */
  lines(list, before = null) {
    const data = new Float32Array(list.length * FLOATS_A_LINE);
    list.forEach(({ start, end, colour, width }, index) =>
      data.set([...start, ...end, ...colour, width], index * FLOATS_A_LINE),
    );
    const made = before ?? this.#lineArray();
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, made.buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, data, this.gl.DYNAMIC_DRAW);
    made.count = list.length;
    return made;
  }

  #lineArray() {
    const gl = this.gl;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, 0, 1, 0, -1, 1, 1, 1]), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    let offset = 0;
    for (const [place, size] of [
      [1, 3],
      [2, 3],
      [3, 4],
      [4, 1],
    ]) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 4 * FLOATS_A_LINE, 4 * offset);
      gl.vertexAttribDivisor(place, 1);
      offset += size;
    }
    return { array, buffer, count: 0 };
  }

  /** A buffer of triangles: corners `[x, y, z, r, g, b, a]`, three by three. */
  triangles(corners, before = null) {
    const gl = this.gl;
    const made = before ?? { array: gl.createVertexArray(), buffer: gl.createBuffer(), count: 0 };
    gl.bindVertexArray(made.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, made.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(corners.flat()), gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 4 * FLOATS_A_CORNER, 0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 4, gl.FLOAT, false, 4 * FLOATS_A_CORNER, 12);
    made.count = corners.length;
    return made;
  }

  begin([red, green, blue]) {
    const gl = this.gl;
    gl.viewport(0, 0, gl.canvas.width, gl.canvas.height);
    gl.clearColor(red, green, blue, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
  }

  /** Faces; with `paper`, the colour of the background, those of guesses are pale. */
  drawFaces(made, matrix, { pixelFromWorld, photoSize, textured, paper = null }) {
    if (made.count === 0) return;
    const gl = this.gl;
    gl.useProgram(this.faceProgram);
    const at = (name) => gl.getUniformLocation(this.faceProgram, name);
    gl.uniformMatrix4fv(at("clip_from_world"), false, matrix);
    gl.uniformMatrix3fv(at("pixel_from_world"), true, pixelFromWorld.flat());
    gl.uniform2f(at("photo_size"), ...photoSize);
    gl.uniform1i(at("textured"), textured && this.photo !== null);
    gl.uniform1i(at("pales"), paper !== null);
    gl.uniform3f(at("paper"), ...(paper ?? [0, 0, 0]));
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.photo ?? this.grey);
    gl.bindVertexArray(made.array);
    gl.drawArrays(gl.TRIANGLES, 0, made.count);
  }

  /** Lines over faces; with `always` also where a face hides them. */
  drawLines(made, matrix, { nearer = 0, always = false } = {}) {
    if (made.count === 0) return;
    const gl = this.gl;
    if (always) gl.disable(gl.DEPTH_TEST);
    gl.useProgram(this.lineProgram);
    gl.uniformMatrix4fv(gl.getUniformLocation(this.lineProgram, "clip_from_world"), false, matrix);
    gl.uniform2f(gl.getUniformLocation(this.lineProgram, "stage"), gl.canvas.width, gl.canvas.height);
    gl.uniform1f(gl.getUniformLocation(this.lineProgram, "nearer"), nearer);
    gl.bindVertexArray(made.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, made.count);
    gl.enable(gl.DEPTH_TEST);
  }
}

function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  return made;
}
