/** A scene as the server tells it, with what the viewer has set. */

/** @typedef {import("./camera.js").Camera} Camera */
/** @typedef {import("./camera.js").Own} Own */
/** @typedef {import("./vector.js").Vector} Vector */

/** A control. Numbers as the shader has them: angles in radians, colours linear.
 * @typedef {{name: string, uniform: string, type: string, unit: "number" | "angle" | "color", default: number[],
 *   low: ?number, high: ?number}} Param */

/** @typedef {{id: number, title: string, shaders: {picture: string, inspect?: string}, own: Own, camera: Camera,
 *   bounds: {low: Vector, high: Vector, holds_everything: boolean},
 *   parts: {name: string, low: Vector, high: Vector}[], params: Param[], values: Record<string, number[]>,
 *   materials: string[], tracer: string, guarantee: string, live: number}} Told */

export class Scene {
  /** @type {Map<string, number[]>} by the param's name */ #set = new Map();

  /**
   * @param {Told} told
   * @param {?Scene} before whose settings stay, where its params have not changed
   */
  constructor(told, before = null) {
    this.told = told;
    /** @type {Record<string, number[]>} */
    this.values = { ...told.values };
    if (before) this.#keep(before);
  }

  /**
   * What was set in the scene before, where the text says the same as it did.
   * @param {Scene} before
   */
  #keep(before) {
    for (const param of this.told.params) {
      const was = before.told.params.find((p) => p.name === param.name);
      const value = before.#set.get(param.name);
      if (!was || !value || !isSame(was, param)) continue;
      if (alike(before.values[was.uniform], this.values[param.uniform])) this.#set.set(param.name, value);
    }
  }

  /**
   * Every uniform but the camera's, as the viewer has set them.
   * @returns {Record<string, number[]>}
   */
  get uniforms() {
    const set = this.told.params.filter((p) => this.#set.has(p.name));
    return { ...this.values, ...Object.fromEntries(set.map((p) => [p.uniform, this.valueOf(p)])) };
  }

  /**
   * The value of every param, by name.
   * @returns {Record<string, number[]>}
   */
  get params() {
    return Object.fromEntries(this.told.params.map((p) => [p.name, this.valueOf(p)]));
  }

  /**
   * @param {Param} param
   * @returns {number[]}
   */
  valueOf(param) {
    return this.#set.get(param.name) ?? this.values[param.uniform] ?? param.default;
  }

  /** Whether the viewer has set any. */
  get isTouched() {
    return this.#set.size > 0;
  }

  /**
   * Whether the viewer has set it.
   * @param {Param} param
   */
  isSet(param) {
    return this.#set.has(param.name);
  }

  /**
   * @param {Param} param
   * @param {number[]} value
   */
  set(param, value) {
    this.#set.set(param.name, value);
  }

  /**
   * Back to the value in the text.
   * @param {Param} param
   */
  reset(param) {
    this.#set.delete(param.name);
  }

  /**
   * Numbers were edited in the text; a param among them follows.
   * @param {Pick<Told, "values">} edit
   */
  follow({ values }) {
    for (const param of this.told.params) {
      const value = values[param.uniform];
      if (value && !alike(value, this.values[param.uniform])) this.#set.delete(param.name);
    }
    Object.assign(this.values, values);
  }

  /**
   * Where things are now.
   * @param {Pick<Told, "bounds" | "parts">} boxes
   */
  place({ bounds, parts }) {
    Object.assign(this.told, { bounds, parts });
  }
}

/**
 * Whether the same values are good for both.
 * @param {Param} a
 * @param {Param} b
 */
const isSame = (a, b) => alike({ ...a, default: 0 }, { ...b, default: 0 });

/**
 * @param {unknown} a
 * @param {unknown} b
 */
export const alike = (a, b) => JSON.stringify(a) === JSON.stringify(b);
