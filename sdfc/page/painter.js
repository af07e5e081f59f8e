/** Draws a scene with WebGL 2: only when something has changed, coarser while it moves, and finer and finer at rest. */

import { uniformsOf } from "./camera.js";
import { Film } from "./film.js";
import { COARSEST, Pace } from "./pace.js";
import { Program } from "./program.js";

/** @typedef {import("./scene.js").Scene} Scene */
/** @typedef {import("./camera.js").Camera} Camera */

const MOST_SAMPLES = 8; // at rest, spread over each pixel
const RESTED = 140; // milliseconds without a move

/** The views, by name: which shader draws them, and what its uniform `shown` is. */
const VIEWS = Object.freeze({
  picture: { entry: "picture", shown: 0 },
  depth: { entry: "inspect", shown: 1 },
  normals: { entry: "inspect", shown: 2 },
  steps: { entry: "inspect", shown: 3 },
  materials: { entry: "inspect", shown: 4 },
});

const UNABLE = Object.freeze({
  title: "This browser has no WebGL 2",
  text: "The view “Server” shows pictures that sdfc draws itself.",
});
const LOST = Object.freeze({
  title: "The browser took the GPU away",
  text: "Waiting until it gives it back; the view “Server” still works.",
});

/** @typedef {keyof typeof VIEWS} View */
/** @typedef {{program: Program, entry: string, scene: Scene}} Drawable */

export class Painter {
  #canvas;
  #told;
  #gl;
  /** @type {?Film} */ #film = null;
  #pace = new Pace();
  /** @type {Drawable[]} compiled or compiling: what is on the screen, and those of the newest scene */ #drawables = [];
  /** @type {?Drawable} */ #current = null;
  /** @type {?Scene} */ #scene = null;
  /** @type {?Camera} */ #camera = null;
  /** @type {View} */ #view = "picture";
  /** @type {[number, number]} */ #size = [1, 1];
  #samples = 0; // of the picture that is on the film, the one that is being drawn not counted
  #row = 0; // of the sample that is being drawn
  #scale = 1;
  #isEmpty = true; // nothing is to be seen yet: anything is better than that
  #movedAt = -Infinity;
  #isAsked = false;
  /** @type {Map<string, {text: string, complaint: string}>} by entry, what the driver does not take */
  #refused = new Map();
  /** @type {?{resolve: (blob: ?Blob) => void}} */ #wanted = null;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {{troubled: () => void, changed: (isBusy: boolean) => void}} told
   */
  constructor(canvas, told) {
    this.#canvas = canvas;
    this.#told = told;
    const asked = { alpha: false, antialias: false, depth: false, powerPreference: "high-performance" };
    this.#gl = /** @type {?WebGL2RenderingContext} */ (canvas.getContext("webgl2", asked));
    this.#open();
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      this.#drawables = [];
      this.#current = this.#film = null;
      this.#refused.clear();
      told.troubled();
    });
    canvas.addEventListener("webglcontextrestored", () => {
      this.#open();
      told.troubled();
    });
  }

  /** Whether there is WebGL 2 at all. */
  get isAble() {
    return this.#gl !== null;
  }

  /** The view that it draws. */
  get view() {
    return this.#view;
  }

  /**
   * Why this view cannot be drawn as the scene is now.
   * @returns {?import("./reports.js").Trouble}
   */
  get trouble() {
    if (!this.#gl) return UNABLE;
    if (!this.#film) return LOST;
    const refused = this.#refused.get(VIEWS[this.#view].entry);
    if (!refused || refused.text !== this.#shader) return null;
    return { title: "This browser's GPU does not take the shader", text: refused.complaint };
  }

  /** The text of the shader that is wanted. */
  get #shader() {
    const shaders = /** @type {Record<string, string> | undefined} */ (this.#scene?.told.shaders);
    return shaders?.[VIEWS[this.#view].entry];
  }

  /** Milliseconds for a picture, and its pixels. */
  get speed() {
    return { milliseconds: this.#pace.estimate(this.#size[0] * this.#size[1]), size: this.#size };
  }

  /**
   * Draw another scene, as soon as its shader is compiled.
   * @param {Scene} scene
   */
  show(scene) {
    this.#scene = scene;
    for (const drawable of this.#drawables) {
      // the same text is the same shader: an edit of comments, or one that was undone at once
      const shaders = /** @type {Record<string, string>} */ (drawable.scene.told.shaders);
      const mine = /** @type {Record<string, string>} */ (scene.told.shaders);
      if (shaders[drawable.entry] === mine[drawable.entry]) drawable.scene = scene;
    }
    this.#drop((drawable) => drawable.scene !== scene && drawable !== this.#current);
    if (this.#current?.scene === scene) this.touch();
    else this.#ask(); // what is on the screen stays until then
  }

  /**
   * @param {Camera} camera
   * @param {boolean} isMoving whether more moves are to be expected
   */
  look(camera, isMoving) {
    this.#camera = camera;
    this.touch(isMoving);
  }

  /** @param {View} view */
  turnTo(view) {
    this.#view = view;
    this.touch();
  }

  /**
   * Whether it is another size.
   * @param {[number, number]} size in pixels of the device
   */
  resize([width, height]) {
    if (width === this.#size[0] && height === this.#size[1]) return false;
    this.#size = [Math.max(1, width), Math.max(1, height)];
    this.touch();
    return true;
  }

  /**
   * What is shown has changed.
   * @param {boolean} [isMoving]
   */
  touch(isMoving = false) {
    if (isMoving) this.#movedAt = performance.now();
    this.#samples = this.#row = 0;
    this.#ask();
  }

  /**
   * The picture as a PNG, once it is all there; null where there is nothing to draw it with.
   * @returns {Promise<?Blob>}
   */
  async saved() {
    if (!this.#film) return null;
    return new Promise((resolve) => {
      this.#wanted = { resolve };
      this.#ask();
    });
  }

  /** Whatever the context has to hold, made. */
  #open() {
    this.#isEmpty = true;
    this.#film = this.#gl ? new Film(this.#gl) : null;
    this.#pace = new Pace();
    this.touch();
  }

  /** Go on with the next picture of the screen. */
  #ask() {
    if (this.#isAsked || !this.#gl || !this.#scene) return;
    this.#isAsked = true;
    this.#told.changed(true);
    requestAnimationFrame(() => {
      this.#isAsked = false;
      if (this.#step()) this.#ask();
      else this.#told.changed(false);
    });
  }

  /** One turn; whether there is more to do. */
  #step() {
    const gl = /** @type {WebGL2RenderingContext} */ (this.#gl);
    if (gl.isContextLost() || !this.#scene || !this.#camera || !this.#film) return false;
    if (this.#pace.isBusy(gl)) return true;
    const isCompiling = this.#compile(gl, this.#scene);
    if (!this.#current) return isCompiling;
    if (this.#isFinished) return this.#deliver(this.#film) || isCompiling;
    this.#paint(gl, this.#film, this.#current, this.#camera);
    return true;
  }

  /**
   * Makes the wanted program the current one when it is ready; whether one is under way.
   * @param {Scene} scene
   * @param {WebGL2RenderingContext} gl
   */
  #compile(gl, scene) {
    const { entry } = VIEWS[this.#view];
    const text = this.#shader;
    const isDrawn = this.#current?.scene === scene && this.#current.entry === entry;
    if (isDrawn || !text || this.#refused.get(entry)?.text === text) return false;
    let wanted = this.#drawables.find((d) => d.scene === scene && d.entry === entry);
    if (!wanted) {
      wanted = { program: new Program(gl, text), entry, scene };
      this.#drawables.push(wanted);
    }
    if (!wanted.program.isDone) return true;
    const complaint = wanted.program.complaint;
    if (complaint) {
      this.#refused.set(entry, { text, complaint });
      this.#told.troubled();
      this.#drop((drawable) => drawable === wanted);
      return false;
    }
    this.#current = wanted;
    this.#drop((drawable) => drawable.scene !== scene);
    this.#pace.forget();
    this.#samples = this.#row = 0;
    return false;
  }

  /**
   * Give programs back.
   * @param {(drawable: Drawable) => boolean} isOld
   */
  #drop(isOld) {
    for (const drawable of this.#drawables.filter(isOld)) drawable.program.delete();
    this.#drawables = this.#drawables.filter((drawable) => !isOld(drawable));
  }

  /** Whether more moves are to be expected. */
  get #isMoving() {
    return performance.now() - this.#movedAt < RESTED;
  }

  /** Whether the picture is as good as it gets; while the camera moves, any will do. */
  get #isFinished() {
    if (this.#isMoving) return this.#samples > 0 && this.#wanted === null;
    const most = this.#film?.isDeep ? MOST_SAMPLES : 1;
    return this.#scale === 1 && this.#samples >= this.#pace.samples(this.#size[0] * this.#size[1], most);
  }

  /**
   * Some rows of a sample; the canvas is shown a sample when it is whole.
   * @param {WebGL2RenderingContext} gl
   * @param {Film} film
   * @param {Drawable} drawable
   * @param {Camera} camera
   */
  #paint(gl, film, drawable, camera) {
    if (this.#row === 0) this.#begin();
    const size = this.#frame;
    const rows = this.#isMoving && this.#samples === 0 ? size[1] : this.#pace.rows(size);
    const count = Math.min(rows, size[1] - this.#row);
    const uniforms = {
      ...drawable.scene.uniforms,
      ...uniformsOf(camera, drawable.scene.told.own, size, jitter(this.#samples)),
      shown: [VIEWS[this.#view].shown],
    };
    film.expose(size, { first: this.#row, count }, this.#samples === 0, () => drawable.program.draw(uniforms));
    this.#row += count;
    if (this.#row >= size[1]) {
      this.#row = 0;
      this.#samples += 1;
      this.#isEmpty = false;
      this.#fit();
      film.show(this.#samples);
    }
    this.#pace.drew(gl, size[0] * count);
  }

  /** The first row of a sample: at which resolution? */
  #begin() {
    const [width, height] = this.#size;
    const scale = this.#isEmpty ? COARSEST : this.#isMoving ? this.#pace.scale(width * height) : 1;
    if (scale === 1 && this.#scale !== 1) this.#samples = 0;
    if (this.#samples === 0) this.#scale = scale;
  }

  /** The size on the film, in pixels. */
  get #frame() {
    const size = this.#size.map((side) => Math.max(1, Math.round(this.#scale * side)));
    return /** @type {[number, number]} */ (size);
  }

  /** The canvas takes the picture's size only when there is something to show in it. */
  #fit() {
    const [width, height] = this.#size;
    if (this.#canvas.width !== width) this.#canvas.width = width;
    if (this.#canvas.height !== height) this.#canvas.height = height;
  }

  /**
   * Hand out a finished picture; whether it may still move.
   * @param {Film} film
   */
  #deliver(film) {
    const wanted = this.#wanted;
    if (wanted && !this.#isMoving) {
      this.#wanted = null;
      film.show(this.#samples); // a canvas keeps its picture only until it has been composed
      this.#canvas.toBlob(wanted.resolve, "image/png");
    }
    return this.#isMoving;
  }
}

/**
 * Where in its pixel a sample lies: the first in the middle, the others where there is most room (the R2 sequence,
 * Roberts 2018).
 * @param {number} sample
 * @returns {[number, number]} in pixels from the middle
 */
function jitter(sample) {
  const at = (/** @type {number} */ step) => ((0.5 + sample * step) % 1) - 0.5;
  return [at(0.7548776662466927), at(0.5698402909980532)];
}
