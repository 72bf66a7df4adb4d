// Draws a triangulated surface by WebGL 2. Points, normals and triangles are textures, from which the
// vertex shader takes what it needs, so that a frame is two uploads and one call, and each corner
// knows the values of all three: those of a mesh with whole numbers are not blended.

const VERTEX = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
uniform sampler2D points, normals;
uniform usampler2D corners;
uniform mat4 view, projection;
centroid out vec3 weights;
out vec3 normal, place;
flat out vec3 values;
ivec2 texel(int i) { return ivec2(i & 1023, i >> 10); }
int corner(int i) { return int(texelFetch(corners, texel(i), 0).r); }
void main() {
  int first = 3 * (gl_VertexID / 3);
  int own = gl_VertexID - first;
  ivec3 at = ivec3(corner(first), corner(first + 1), corner(first + 2));
  for (int k = 0; k < 3; k++) values[k] = texelFetch(points, texel(at[k]), 0).w;
  weights = vec3(own == 0, own == 1, own == 2);
  vec4 eye = view * vec4(texelFetch(points, texel(at[own]), 0).xyz, 1);
  normal = mat3(view) * texelFetch(normals, texel(at[own]), 0).xyz;
  place = eye.xyz;
  gl_Position = projection * eye;
}`;

const FRAGMENT = `#version 300 es
precision highp float;
// Not beyond the triangle, where an edge would begin.
centroid in vec3 weights;
in vec3 normal, place;
flat in vec3 values;
uniform sampler2D map;
uniform bool flatShading, edges, whole;
out vec4 colour;
const vec3 none = vec3(0.62, 0.64, 0.66);
void main() {
  float value = dot(values, weights);
  // A corner without a value leaves the others theirs.
  if (whole || min(values.x, min(values.y, values.z)) < 0.0) {
    value = weights.x > max(weights.y, weights.z) ? values.x
          : weights.y > weights.z ? values.y : values.z;
  }
  vec3 base = value < 0.0 ? none : texture(map, vec2(value, 0.5)).rgb;
  vec3 n = flatShading ? cross(dFdx(place), dFdy(place)) : normal;
  n = normalize(n);
  if (!gl_FrontFacing && !flatShading) n = -n;
  // Light from the upper left, and a soft highlight half-way to the viewer.
  float diffuse = max(dot(n, vec3(-0.451, 0.551, 0.702)), 0.0);
  float shine = pow(max(dot(n, vec3(-0.245, 0.299, 0.922)), 0.0), 40.0);
  vec3 lit = base * (0.6 + 0.45 * diffuse) + 0.08 * shine;
  // The inside, seen through a border or from within, is darker.
  if (!gl_FrontFacing) lit *= 0.6;
  if (edges) {
    vec3 width = fwidth(weights);
    vec3 far = smoothstep(vec3(0.0), 1.1 * width, weights);
    // Where triangles are a few pixels wide, lines would hide the colours.
    float strength = 0.4 * clamp(0.35 / max(width.x, max(width.y, width.z)) - 1.0, 0.0, 1.0);
    lit *= 1.0 - strength * (1.0 - min(far.x, min(far.y, far.z)));
  }
  colour = vec4(lit, 1);
}`;

/** Texels of a row of the textures of points and triangles; `texel` in the shader has it too. */
const ROW = 1024;

/** Whether the processor draws, for which four samples of each pixel are too many. */
function drawnBySoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const names = gl?.getExtension("WEBGL_debug_renderer_info");
  return !!names && /swiftshader|llvmpipe|software/i.test(gl.getParameter(names.UNMASKED_RENDERER_WEBGL));
}

class Surface {
  constructor(canvas) {
    this.canvas = canvas;
    this.gl = canvas.getContext("webgl2", { antialias: !drawnBySoftware() });
    if (this.gl) this.prepare();
  }

  /** Makes what the graphics card holds; once more after it has lost it. */
  prepare() {
    const gl = this.gl;
    this.program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
      this.note = gl.getShaderInfoLog(shader) || this.note;
    }
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS) && !gl.isContextLost()) {
      throw new Error(`WebGL: ${this.note || gl.getProgramInfoLog(this.program)}`);
    }
    gl.useProgram(this.program);
    const uniforms = ["points", "normals", "corners", "map", "view", "projection", "flatShading",
                      "edges", "whole"];
    this.at = Object.fromEntries(uniforms.map((n) => [n, gl.getUniformLocation(this.program, n)]));
    this.textures = ["points", "normals", "corners", "map"].map((name, unit) => {
      const texture = gl.createTexture();
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      const filter = name === "map" ? gl.LINEAR : gl.NEAREST;
      for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
        gl.texParameteri(gl.TEXTURE_2D, side, filter);
      }
      for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) {
        gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
      }
      gl.uniform1i(this.at[name], unit);
      return texture;
    });
    gl.bindVertexArray(gl.createVertexArray());
    gl.enable(gl.DEPTH_TEST);
    this.count = 0;
  }

  /** Triangles, three points each. */
  setTriangles(corners) {
    const gl = this.gl;
    const rows = Math.ceil(corners.length / ROW);
    const filled = new Uint32Array(rows * ROW);
    filled.set(corners);
    gl.activeTexture(gl.TEXTURE2);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R32UI, ROW, rows, 0, gl.RED_INTEGER, gl.UNSIGNED_INT, filled);
    this.count = corners.length;
  }

  /** Points and their normals, three numbers each. */
  setPoints(positions, normals, values) {
    this.positions = positions;
    this.upload(1, normals, null);
    this.setValues(values);
  }

  /** Places on the colour map, one for each point; below 0 for none. */
  setValues(values) {
    this.upload(0, this.positions, values);
  }

  /** Puts three numbers a point, and a fourth where there is one, into a texture. */
  upload(unit, numbers, fourth) {
    const gl = this.gl;
    const count = numbers.length / 3;
    const rows = Math.ceil(count / ROW);
    const filled = new Float32Array(4 * rows * ROW);
    for (let i = 0; i < count; i++) {
      filled[4 * i] = numbers[3 * i];
      filled[4 * i + 1] = numbers[3 * i + 1];
      filled[4 * i + 2] = numbers[3 * i + 2];
      if (fourth) filled[4 * i + 3] = fourth[i];
    }
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, ROW, rows, 0, gl.RGBA, gl.FLOAT, filled);
  }

  setMap(kind) {
    const gl = this.gl;
    gl.activeTexture(gl.TEXTURE3);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, colourTable(kind));
    gl.uniform1i(this.at.whole, kind === "whole" ? 1 : 0);
  }

  draw(camera, options) {
    const gl = this.gl;
    const { width, height } = this.canvas;
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(this.at.view, false, camera.view());
    gl.uniformMatrix4fv(this.at.projection, false, camera.projection(width / height));
    gl.uniform1i(this.at.flatShading, options.flat ? 1 : 0);
    gl.uniform1i(this.at.edges, options.edges ? 1 : 0);
    gl.drawArrays(gl.TRIANGLES, 0, this.count);
  }

  /** The point nearest to a place of the picture, in CSS pixels, and to the viewer; or −1. */
  pointAt(camera, x, y, reach) {
    const { clientWidth, clientHeight } = this.canvas;
    const view = camera.view();
    const projection = camera.projection(clientWidth / clientHeight);
    let best = -1, nearest = Infinity;
    for (let i = 0; i < this.positions.length / 3; i++) {
      const p = this.positions.subarray(3 * i, 3 * i + 3);
      const eye = [0, 1, 2].map((k) => view[k] * p[0] + view[4 + k] * p[1] + view[8 + k] * p[2] + view[12 + k]);
      const px = (0.5 + (0.5 * projection[0] * eye[0]) / -eye[2]) * clientWidth;
      const py = (0.5 - (0.5 * projection[5] * eye[1]) / -eye[2]) * clientHeight;
      const off = Math.hypot(px - x, py - y);
      if (off > reach) continue;
      // A pixel off weighs as much as a hundredth of the radius farther away.
      const cost = -eye[2] + (off * camera.radius) / 100;
      if (cost < nearest) [best, nearest] = [i, cost];
    }
    return best;
  }
}
