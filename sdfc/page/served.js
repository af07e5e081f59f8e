/** The view that the server draws: asked for when the camera rests, shown over the picture until anything changes. */

/** @typedef {import("./camera.js").Camera} Camera */
/** @typedef {{camera: Camera, params: Record<string, number[]>, size: [number, number]}} Order */

const RESTED = 150; // milliseconds without a change until the server is asked
const LARGEST = 1920; // pixels that it draws, on either side
const SMALLEST = 16;

/** @typedef {"asked" | "shown" | "refused" | "lost"} State */

export class Served {
  #image;
  #send;
  #told;
  #request = 0; // the newest
  #announced = 0; // whose bytes come next
  /** @type {number | undefined} */ #timer;
  /** @type {?Order} */ #order = null;
  /** @type {?Blob} */ #blob = null;
  /** @type {((blob: ?Blob) => void)[]} who waits for the picture */ #waiting = [];
  #isAwaited = false; // asked for, or about to be
  isOn = false;

  /**
   * @param {HTMLImageElement} image over the picture
   * @param {(message: import("./live.js").Message) => boolean} send
   * @param {(state: State, text: string) => void} told
   */
  constructor(image, send, told) {
    this.#image = image;
    this.#send = send;
    this.#told = told;
  }

  /**
   * The server's picture, once it is there; null where none comes.
   * @returns {Promise<?Blob>}
   */
  async saved() {
    if (!this.#image.hidden) return this.#blob;
    if (!this.#isAwaited) return null;
    return new Promise((resolve) => this.#waiting.push(resolve));
  }

  /**
   * What is shown has changed, or the view has.
   * @param {Order} order
   */
  want(order) {
    clearTimeout(this.#timer);
    this.#request += 1; // what is under way has become stale
    this.#image.hidden = true;
    this.#order = order;
    if (!this.isOn) return this.#settle(null);
    this.#told("asked", "");
    this.#isAwaited = true;
    this.#timer = setTimeout(() => {
      const { camera, params } = order;
      if (!this.#send({ type: "draw", request: this.#request, camera, params, size: bounded(order.size) })) this.#lose();
    }, RESTED);
  }

  /**
   * What is awaited does not come without a connection; with the next one it is asked for again.
   * @param {boolean} isConnected
   */
  connected(isConnected) {
    if (!this.isOn || !this.#image.hidden || !this.#order) return;
    if (isConnected) this.want(this.#order);
    else this.#lose();
  }

  #lose() {
    clearTimeout(this.#timer);
    this.#told("lost", "");
    this.#settle(null);
  }

  /**
   * Nothing is awaited any more.
   * @param {?Blob} blob
   */
  #settle(blob) {
    this.#isAwaited = false;
    for (const resolve of this.#waiting.splice(0)) resolve(blob);
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
    if (request !== this.#request) return;
    this.#told("refused", text);
    this.#settle(null);
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
    this.#settle(this.#blob);
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
