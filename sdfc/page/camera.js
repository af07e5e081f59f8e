/** The camera: from where it stands to the shader's uniforms (as sdfc/plan/view.py makes them), and how it is moved. */

import { cross, dot, length, minus, plus, times, turned, unit } from "./vector.js";

/** @typedef {import("./vector.js").Vector} Vector */
/** In the scene's units; `fov` in radians, or the `height` of what a camera without perspective sees.
 * @typedef {{eye: Vector, target: Vector, up: Vector, fov: ?number, height: ?number}} Camera */
/** The scene's own coordinates: (p - centre) / radius. @typedef {{centre: Vector, radius: number}} Own */

const STEEPEST = Math.PI / 2 - 1e-3; // a camera that is orbited stays this side of the poles
const NEAREST = 1e-4; // between eye and target, of the scene's radius
const FARTHEST = 1e4;
const SHARP = 12; // digits of a fov, for those near 180deg, and of a height

/**
 * Unit vectors to the right, upward and ahead.
 * @param {Camera} camera
 * @returns {{right: Vector, above: Vector, ahead: Vector}}
 */
export function axesOf(camera) {
  const ahead = unit(minus(camera.target, camera.eye));
  let right = cross(ahead, camera.up);
  if (length(right) < 1e-9 * length(camera.up)) {
    right = cross(ahead, Math.abs(ahead[2]) < 0.9 ? [0, 0, 1] : [0, 1, 0]);
  }
  right = unit(right);
  return { right, above: cross(right, ahead), ahead };
}

/**
 * Half the height of what is seen, at distance 1, or anywhere without perspective.
 * @param {Camera} camera
 */
const halfOf = ({ fov, height }) => (height === null ? Math.tan(0.5 * Number(fov)) : 0.5 * height);

/**
 * Every camera uniform of the shaders.
 * @param {Camera} camera
 * @param {Own} own
 * @param {[number, number]} size in pixels
 * @param {[number, number]} [jitter] of the sample, in pixels from the pixel's centre
 * @returns {Record<string, number[]>}
 */
export function uniformsOf(camera, own, size, jitter = [0, 0]) {
  const [width, height] = size;
  const { right, above, ahead } = axesOf(camera);
  const isParallel = camera.height !== null;
  const half = isParallel ? halfOf(camera) / own.radius : halfOf(camera);
  return {
    eye: times(1 / own.radius, minus(camera.eye, own.centre)),
    axis_x: times((half * width) / height, right),
    axis_y: times(half, above),
    axis_z: ahead,
    window: [width, height, ...jitter],
    pixel: isParallel ? [half / height, 0, 0] : [0, half / height, 1],
  };
}

/**
 * Around the target.
 * @param {Camera} camera
 * @param {number} aside in radians, to the right
 * @param {number} up in radians
 * @returns {Camera}
 */
export function orbited(camera, aside, up) {
  const vertical = unit(camera.up);
  const offset = minus(camera.eye, camera.target);
  const distance = length(offset);
  const height = Math.asin(Math.min(1, Math.max(-1, dot(offset, vertical) / distance)));
  const lifted = Math.min(STEEPEST, Math.max(-STEEPEST, height + up));
  const back = turned(unit(cross(axesOf(camera).right, vertical)), vertical, aside);
  const toward = plus(times(Math.cos(lifted), back), times(Math.sin(lifted), vertical));
  return { ...camera, eye: plus(camera.target, times(distance, toward)) };
}

/**
 * Eye and target together.
 * @param {Camera} camera
 * @param {number} right in heights of the picture
 * @param {number} up
 * @returns {Camera}
 */
export function panned(camera, right, up) {
  const axes = axesOf(camera);
  const distance = camera.height === null ? length(minus(camera.eye, camera.target)) : 1;
  const whole = 2 * halfOf(camera) * distance;
  const moved = plus(times(right * whole, axes.right), times(up * whole, axes.above));
  return { ...camera, eye: plus(camera.eye, moved), target: plus(camera.target, moved) };
}

/**
 * Nearer (a factor below 1) or farther.
 * @param {Camera} camera
 * @param {number} factor
 * @param {number} radius of the scene
 * @returns {Camera}
 */
export function zoomed(camera, factor, radius) {
  const bounded = (/** @type {number} */ size) =>
    Math.min(FARTHEST * radius, Math.max(NEAREST * radius, size * factor));
  if (camera.height !== null) return { ...camera, height: bounded(camera.height) };
  const offset = minus(camera.eye, camera.target);
  const distance = length(offset);
  return { ...camera, eye: plus(camera.target, times(bounded(distance) / distance, offset)) };
}

/**
 * Where points are in the picture: x and y from -1 to 1 (right, up) after division by w.
 * @param {Camera} camera
 * @param {number} aspect width / height
 * @returns {(p: Vector) => [number, number, number]} x, y and w; w is above 0 in front of the eye
 */
export function projection(camera, aspect) {
  const { right, above, ahead } = axesOf(camera);
  const half = halfOf(camera);
  return (p) => {
    const offset = minus(p, camera.eye);
    const w = camera.height === null ? dot(offset, ahead) : 1;
    return [dot(offset, right) / (half * aspect), dot(offset, above) / half, w];
  };
}

/**
 * As a scene has it, with as many digits as keep the picture where it is, to a hundredth of a pixel of a large screen.
 * @param {Camera} camera
 */
export function textOf(camera) {
  const distance = length(minus(camera.eye, camera.target));
  const up = unit(camera.up);
  // the nearer it looks along `up`, the more does a digit roll it
  const steepness = Math.max(1e-9, length(cross(axesOf(camera).ahead, up)));
  const whole = 2 * halfOf(camera) * (camera.height === null ? distance : 1);
  const finest = Math.min(whole, distance * steepness);
  const parts = [`eye: ${rounded(camera.eye, finest)}`, `target: ${rounded(camera.target, finest)}`];
  const above = rounded(up, steepness);
  if (above !== "[0, 1, 0]") parts.push(`up: ${above}`);
  if (camera.height !== null) parts.push(`height: ${Number(camera.height.toPrecision(SHARP))}`);
  else parts.push(`fov: ${Number(((Number(camera.fov) * 180) / Math.PI).toPrecision(SHARP))}deg`);
  return `camera { ${parts.join(", ")} }`;
}

/**
 * A list whose numbers are off by less than 1e-7 of `size`.
 * @param {Vector} v
 * @param {number} size
 */
function rounded(v, size) {
  const decimals = Math.min(100, Math.max(0, 7 - Math.floor(Math.log10(size))));
  return `[${v.map((x) => Number(x.toFixed(decimals)) + 0).join(", ")}]`;
}
