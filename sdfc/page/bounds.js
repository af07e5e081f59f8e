/** The boxes of a scene and of its parts, as lines over any view. */

import { projection } from "./camera.js";

/** @typedef {import("./scene.js").Scene} Scene */
/** @typedef {import("./camera.js").Camera} Camera */
/** @typedef {import("./vector.js").Vector} Vector */
/** @typedef {{low: Vector, high: Vector, name?: string}} Box */

const NEAR = 1e-3; // of the scene's radius: lines end so far in front of the eye
const MOST_NAMES = 8; // more of them hide each other

/** Corners by number: bit 0 is x, bit 1 y, bit 2 z. */
const EDGES = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((corner) =>
  [1, 2, 4].filter((bit) => !(corner & bit)).map((bit) => [corner, corner | bit]),
);

export class Bounds {
  #canvas;
  isShown = false;

  /** @param {HTMLCanvasElement} canvas over the picture, of the same size */
  constructor(canvas) {
    this.#canvas = canvas;
  }

  /**
   * @param {?Scene} scene
   * @param {?Camera} camera
   * @param {[number, number]} size in pixels of the device
   */
  draw(scene, camera, size) {
    this.#canvas.hidden = !this.isShown;
    if (!this.isShown || !scene || !camera) return;
    [this.#canvas.width, this.#canvas.height] = size;
    const context = /** @type {CanvasRenderingContext2D} */ (this.#canvas.getContext("2d"));
    const ratio = globalThis.devicePixelRatio;
    const pen = new Pen(context, projection(camera, size[0] / size[1]), size, NEAR * scene.told.own.radius);
    const named = scene.told.parts.length <= MOST_NAMES;
    for (const part of scene.told.parts) {
      pen.box(part, ratio, "rgb(255 255 255 / 0.5)");
      if (named) pen.name(part, ratio);
    }
    pen.box(scene.told.bounds, 2 * ratio, "rgb(255 196 64)", "rgb(0 0 0 / 0.3)");
  }
}

class Pen {
  /**
   * @param {CanvasRenderingContext2D} context
   * @param {(p: Vector) => [number, number, number]} project
   * @param {[number, number]} size
   * @param {number} near
   */
  constructor(context, project, size, near) {
    this.context = context;
    this.project = project;
    this.size = size;
    this.near = near;
  }

  /**
   * @param {Box} box
   * @param {number} width
   * @param {string} color
   * @param {string} [hem] around the lines
   */
  box(box, width, color, hem = "transparent") {
    const corners = cornersOf(box).map(this.project);
    this.context.beginPath();
    for (const [from, to] of EDGES) this.#line(corners[from], corners[to]);
    this.#stroke(2 * width, hem);
    this.#stroke(width, color);
  }

  /**
   * At the middle of its top.
   * @param {Box} box
   * @param {number} ratio
   */
  name(box, ratio) {
    const at = this.project([(box.low[0] + box.high[0]) / 2, box.high[1], (box.low[2] + box.high[2]) / 2]);
    if (!box.name || at[2] < this.near) return;
    const [x, y] = this.#place(at);
    this.context.font = `${12 * ratio}px system-ui, sans-serif`;
    this.context.textAlign = "center";
    this.context.lineJoin = "round";
    this.context.lineWidth = 3 * ratio;
    this.context.strokeStyle = "rgb(0 0 0 / 0.55)";
    this.context.strokeText(box.name, x, y - 4 * ratio);
    this.context.fillStyle = "white";
    this.context.fillText(box.name, x, y - 4 * ratio);
  }

  /**
   * @param {number} width
   * @param {string} color
   */
  #stroke(width, color) {
    this.context.lineWidth = width;
    this.context.strokeStyle = color;
    this.context.stroke();
  }

  /**
   * What of it lies in front of the eye.
   * @param {[number, number, number]} from
   * @param {[number, number, number]} to
   */
  #line(from, to) {
    if (from[2] < this.near && to[2] < this.near) return;
    this.context.moveTo(...this.#place(cut(from, to, this.near)));
    this.context.lineTo(...this.#place(cut(to, from, this.near)));
  }

  /**
   * @param {[number, number, number]} at
   * @returns {[number, number]}
   */
  #place([x, y, w]) {
    return [0.5 * this.size[0] * (1 + x / w), 0.5 * this.size[1] * (1 - y / w)];
  }
}

/**
 * @param {Box} box
 * @returns {Vector[]}
 */
const cornersOf = ({ low, high }) =>
  [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => [
    corner & 1 ? high[0] : low[0],
    corner & 2 ? high[1] : low[1],
    corner & 4 ? high[2] : low[2],
  ]);

/**
 * `from`, or the point between it and `to` where w is `near`.
 * @param {[number, number, number]} from
 * @param {[number, number, number]} to
 * @param {number} near
 * @returns {[number, number, number]}
 */
function cut(from, to, near) {
  if (from[2] >= near) return from;
  const share = (near - from[2]) / (to[2] - from[2]);
  return [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1]), near];
}
