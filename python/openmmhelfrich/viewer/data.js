// Reads the header and the block of the page, as page.py writes them.

/** The bytes of base64, unpacked. */
async function unpacked(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The scene: what the header has, with arrays of the meshes and the frames. */
async function readScene(headerText, blockText) {
  const scene = JSON.parse(headerText);
  const bytes = await unpacked(blockText);
  let place = 0;
  // The first bytes of all numbers come first, then the second ones.
  const take = (count, size, result) => {
    for (let part = 0; part < size; part++, place += count) {
      for (let i = 0; i < count; i++) result[i] |= bytes[place + i] << (8 * part);
    }
    return result;
  };
  let before = null;
  for (const mesh of scene.meshes) {
    mesh.corners = take(3 * mesh.triangles, 4, new Uint32Array(3 * mesh.triangles));
    if (mesh.after) for (let i = 0; i < before.length; i++) mesh.corners[i] ^= before[i];
    mesh.surfaces = take(mesh.points, 2, new Uint16Array(mesh.points));
    before = mesh.corners;
  }
  for (const frame of scene.frames) {
    frame.mesh = scene.meshes[frame.mesh];
    const count = frame.mesh.points;
    frame.axes = [0, 1, 2].map(() => take(count, 2, new Uint16Array(count)));
    frame.fields = scene.fields.map(() => take(count, 2, new Uint16Array(count)));
  }
  return scene;
}

/** Whole numbers of 16 bits across a range, and the one that stands for no value. */
const STEPS = 65534;
const NONE = 65535;

/** Positions of a frame from its middle, nm, three numbers a point. */
function positionsOf(frame) {
  const count = frame.mesh.points;
  const result = new Float32Array(3 * count);
  for (let axis = 0; axis < 3; axis++) {
    const from = frame.low[axis];
    const step = frame.size / STEPS;
    const whole = frame.axes[axis];
    for (let i = 0; i < count; i++) result[3 * i + axis] = from + step * whole[i];
  }
  return result;
}

/** The value of a field at a point, or NaN. */
function valueAt(scene, frame, field, point) {
  const whole = frame.fields[field][point];
  const { least, width } = scene.fields[field];
  return whole === NONE ? NaN : least + (width * whole) / STEPS;
}

/** Normals of the points, from the triangles around by their area, three numbers a point. */
function normalsOf(positions, corners) {
  const normals = new Float32Array(positions.length);
  for (let t = 0; t < corners.length; t += 3) {
    const a = 3 * corners[t], b = 3 * corners[t + 1], c = 3 * corners[t + 2];
    const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1];
    const uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1];
    const vz = positions[c + 2] - positions[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const at of [a, b, c]) {
      normals[at] += x;
      normals[at + 1] += y;
      normals[at + 2] += z;
    }
  }
  for (let i = 0; i < normals.length; i += 3) {
    const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) || 1;
    for (let k = 0; k < 3; k++) normals[i + k] /= length;
  }
  return normals;
}
