/** How much may be drawn at a time, by how long that took the last time. */

const SMOOTH = 30; // milliseconds that a picture may take while the camera moves
const POLITE = 60; // milliseconds that the page and the rest of the screen may have to wait for a part of one at rest
const REMEMBERED = 3; // times: the first one of a shader is slow
const REFINING = 2500; // milliseconds that a picture at rest may go on getting finer
export const COARSEST = 0.25; // of the resolution, while the camera moves
const GUESS = 1e-4; // milliseconds a pixel of a shader that was never drawn

export class Pace {
  /** @type {number[]} milliseconds a pixel, the last few times */ #measured = [];
  /** @type {?{sync: WebGLSync, pixels: number, since: number}} */ #awaited = null;

  /** Another shader: nothing is known of it. */
  forget() {
    this.#measured = [];
  }

  /**
   * Something was drawn.
   * @param {WebGL2RenderingContext} gl
   * @param {number} pixels
   */
  drew(gl, pixels) {
    const sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    if (sync) this.#awaited = { sync, pixels, since: performance.now() };
  }

  /**
   * Whether the GPU still draws what it was given last.
   * @param {WebGL2RenderingContext} gl
   */
  isBusy(gl) {
    const awaited = this.#awaited;
    if (!awaited) return false;
    if (!gl.isContextLost() && gl.getSyncParameter(awaited.sync, gl.SYNC_STATUS) !== gl.SIGNALED) return true;
    gl.deleteSync(awaited.sync);
    const took = (performance.now() - awaited.since) / awaited.pixels;
    this.#measured = [...this.#measured.slice(1 - REMEMBERED), took];
    this.#awaited = null;
    return false;
  }

  /**
   * Milliseconds for a picture, if nothing comes between.
   * @param {number} pixels
   */
  estimate(pixels) {
    return (this.#measured.length ? Math.min(...this.#measured) : GUESS) * pixels;
  }

  /**
   * The share of each side to draw while the camera moves.
   * @param {number} pixels of the picture
   */
  scale(pixels) {
    const share = Math.sqrt(SMOOTH / this.estimate(pixels));
    return share > 0.8 ? 1 : Math.max(COARSEST, share);
  }

  /**
   * How many samples to spread over each pixel of a picture at rest.
   * @param {number} pixels
   * @param {number} most
   */
  samples(pixels, most) {
    return Math.min(most, Math.max(1, Math.floor(REFINING / this.estimate(pixels))));
  }

  /**
   * How many rows of a picture at rest to draw at a time.
   * @param {[number, number]} size
   */
  rows([width, height]) {
    return Math.min(height, Math.max(8, Math.floor(POLITE / this.estimate(width))));
  }
}
