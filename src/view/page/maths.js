// Vectors of three numbers, and 4×4 matrices column by column, as WebGL takes them.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a, f) => [a[0] * f, a[1] * f, a[2] * f];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0],
];
export const length = (a) => Math.hypot(...a);
export const unit = (a) => scale(a, 1 / (length(a) || 1));

/** Clip coordinates of a perspective view: the eye looks along `forward`, `yfov` in radians. */
export function perspective(eye, forward, yfov, aspect, near, far) {
  const right = unit(cross(forward, [0, 1, 0]));
  const up = cross(right, forward);
  const f = 1 / Math.tan(yfov / 2);
  const back = scale(forward, -1);
  const [a, b] = [(far + near) / (near - far), (2 * far * near) / (near - far)];
  const rows = [scale(right, f / aspect), scale(up, f), back];
  const moved = rows.map((row) => -dot(row, eye));
  const matrix = new Float32Array(16);
  for (let k = 0; k < 3; k++) {
    matrix[4 * k] = rows[0][k];
    matrix[4 * k + 1] = rows[1][k];
    matrix[4 * k + 2] = a * back[k];
    matrix[4 * k + 3] = -back[k];
  }
  matrix[12] = moved[0];
  matrix[13] = moved[1];
  matrix[14] = a * moved[2] + b;
  matrix[15] = -moved[2];
  return matrix;
}

/** The direction through a point of the picture, both coordinates from −1 to 1. */
export function ray(forward, yfov, aspect, x, y) {
  const right = unit(cross(forward, [0, 1, 0]));
  const up = cross(right, forward);
  const t = Math.tan(yfov / 2);
  return unit(add(forward, add(scale(right, x * t * aspect), scale(up, y * t))));
}

/** Where a ray meets a horizontal plane, or null where it does not. */
export function onPlane(eye, direction, height) {
  const way = (height - eye[1]) / direction[1];
  return way > 0 && Number.isFinite(way) ? add(eye, scale(direction, way)) : null;
}
