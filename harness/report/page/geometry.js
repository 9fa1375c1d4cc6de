// ---- Geometry: vectors as arrays, quaternions as [w, x, y, z], matrices of 16 by columns.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = a => Math.hypot(a[0], a[1], a[2]);
const unit = a => scale(a, 1 / (norm(a) || 1));

function rotate(q, v) {
  const u = [q[1], q[2], q[3]], t = scale(cross(u, v), 2);
  return add(add(v, scale(t, q[0])), cross(u, t));
}
function multiplyQuaternions(a, b) {
  return [a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
    a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]];
}
const conjugate = q => [q[0], -q[1], -q[2], -q[3]];
function unitQuaternion(q) {
  const n = Math.hypot(...q) || 1;
  return q.map(x => x / n);
}

// Poses {p, q}: B in A, C in B -> C in A.
const compose = (X, Y) => ({p: add(X.p, rotate(X.q, Y.p)), q: multiplyQuaternions(X.q, Y.q)});
const transform = (X, v) => add(X.p, rotate(X.q, v));

// Of a box with these half edges: its unit cube (±1) to the world.
function boxMatrix(X, half) {
  const m = new Float32Array(16);
  [[half[0], 0, 0], [0, half[1], 0], [0, 0, half[2]]].forEach((axis, i) => m.set(rotate(X.q, axis), 4 * i));
  m.set(X.p, 12);
  m[15] = 1;
  return m;
}

function multiply(a, b) {
  const m = new Float32Array(16);
  for (let c = 0; c < 4; ++c)
    for (let r = 0; r < 4; ++r) m[4 * c + r] = a[r] * b[4 * c] + a[4 + r] * b[4 * c + 1] + a[8 + r] * b[4 * c + 2] + a[12 + r] * b[4 * c + 3];
  return m;
}

function perspective(fieldOfView, aspect, near, far) {
  const f = 1 / Math.tan(fieldOfView / 2), m = new Float32Array(16);
  m[0] = f / aspect; m[5] = f; m[10] = (far + near) / (near - far); m[11] = -1; m[14] = 2 * far * near / (near - far);
  return m;
}

function lookAt(eye, target, up) {
  const z = unit(sub(eye, target)), x = unit(cross(up, z)), y = cross(z, x);
  return new Float32Array([x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1]);
}

// World to normalised device coordinates; w is the depth before the eye.
function project(m, p) {
  const at = r => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];
  const w = at(3);
  return [at(0) / w, at(1) / w, at(2) / w, w];
}

const cubeCorners = [0, 1, 2, 3, 4, 5, 6, 7].map(i => [i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1]);
const cubeEdges = [];
for (let i = 0; i < 8; ++i) for (const bit of [1, 2, 4]) if (!(i & bit)) cubeEdges.push([i, i | bit]);
const cubeFaces = [];  // four corners around, and the outward normal
for (let axis = 0; axis < 3; ++axis) {
  const [u, v] = [1 << (axis + 1) % 3, 1 << (axis + 2) % 3];
  for (const side of [0, 1]) {
    const base = side << axis, around = [base, base | u, base | u | v, base | v], normal = [0, 0, 0];
    normal[axis] = side ? 1 : -1;
    cubeFaces.push({corners: side ? around : around.reverse(), normal});
  }
}

// Distance along a ray to a box, or Infinity.
function hitBox(origin, direction, X, half) {
  const inverse = conjugate(X.q), o = rotate(inverse, sub(origin, X.p)), d = rotate(inverse, direction);
  let near = -Infinity, far = Infinity;
  for (let i = 0; i < 3; ++i) {
    const a = (-half[i] - o[i]) / d[i], b = (half[i] - o[i]) / d[i];
    near = Math.max(near, Math.min(a, b));
    far = Math.min(far, Math.max(a, b));
  }
  return near <= far && far > 0 ? Math.max(near, 0) : Infinity;
}
