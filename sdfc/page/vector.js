/** Vectors of three numbers, as arrays. Nothing here changes its arguments. */

/** @typedef {[number, number, number]} Vector */

/**
 * @param {Vector} a
 * @param {Vector} b
 * @returns {Vector}
 */
export const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];

/**
 * @param {Vector} a
 * @param {Vector} b
 * @returns {Vector}
 */
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];

/**
 * @param {number} k
 * @param {Vector} v
 * @returns {Vector}
 */
export const times = (k, v) => [k * v[0], k * v[1], k * v[2]];

/**
 * @param {Vector} a
 * @param {Vector} b
 */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** @param {Vector} v */
export const length = (v) => Math.hypot(...v);

/**
 * @param {Vector} a
 * @param {Vector} b
 * @returns {Vector}
 */
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/**
 * The vector at length 1; a zero vector as it is.
 * @param {Vector} v
 * @returns {Vector}
 */
export function unit(v) {
  const size = length(v);
  return size > 0 ? [v[0] / size, v[1] / size, v[2] / size] : v;
}

/**
 * `v`, at right angles to the unit vector `axis`, turned around it.
 * @param {Vector} v
 * @param {Vector} axis
 * @param {number} angle in radians, by the right-hand rule
 * @returns {Vector}
 */
export const turned = (v, axis, angle) => plus(times(Math.cos(angle), v), times(Math.sin(angle), cross(axis, v)));
