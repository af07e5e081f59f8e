/** The view that the server draws: asked for when the camera rests, shown over the picture until anything changes. */

/** @typedef {import("./camera.js").Camera} Camera */
/** @typedef {{camera: Camera, params: Record<string, number[]>, size: [number, number]}} Order */

const RESTED = 150; // milliseconds without a change until the server is asked
const LARGEST = 1920; // pixels that it draws, on either side
const SMALLEST = 16;

export class Served {
  #image;
  #send;
  #told;
  #request = 0; // the newest
  #announced = 0; // whose bytes come next
  /** @type {number | undefined} */ #timer;
  /** @type {?Blob} */ #blob = null;
  isOn = false;

  /**
   * @param {HTMLImageElement} image over the picture
   * @param {(message: import("./live.js").Message) => boolean} send
   * @param {(state: "asked" | "shown" | "refused", text: string) => void} told
   */
  constructor(image, send, told) {
    this.#image = image;
    this.#send = send;
    this.#told = told;
  }

  /** The server's picture that is shown now. */
  get blob() {
    return this.#image.hidden ? null : this.#blob;
  }

  /**
   * What is shown has changed, or the view has.
   * @param {?Order} order
   */
  want(order) {
    clearTimeout(this.#timer);
    this.#request += 1; // what is under way has become stale
    this.#image.hidden = true;
    if (!this.isOn || !order) return;
    this.#told("asked", "");
    this.#timer = setTimeout(() => {
      const { camera, params } = order;
      this.#send({ type: "draw", request: this.#request, camera, params, size: bounded(order.size) });
    }, RESTED);
  }

  /**
   * A picture follows.
   * @param {number} request
   */
  announce(request) {
    this.#announced = request;
  }

  /**
   * @param {number} request
   * @param {string} text
   */
  refused(request, text) {
    if (request === this.#request) this.#told("refused", text);
  }

  /** @param {Blob} bytes */
  async take(bytes) {
    const request = this.#announced;
    if (request !== this.#request || !this.isOn) return;
    this.#blob = new Blob([bytes], { type: "image/png" });
    const url = URL.createObjectURL(this.#blob);
    this.#image.src = url;
    try {
      await this.#image.decode();
    } catch {
      return; // a newer one has taken its place
    } finally {
      URL.revokeObjectURL(url);
    }
    if (request !== this.#request || !this.isOn) return;
    this.#image.hidden = false;
    this.#told("shown", "");
  }
}

/**
 * The size itself, or the largest of its shape that the server draws.
 * @param {[number, number]} size
 * @returns {[number, number]}
 */
function bounded(size) {
  const scale = Math.min(1, LARGEST / Math.max(...size));
  const side = (/** @type {number} */ pixels) => Math.max(SMALLEST, Math.round(scale * pixels));
  return [side(size[0]), side(size[1])];
}
