/** The connection to `sdfc watch`: messages in, requests out, and made again by itself when it is lost. */

const FIRST_WAIT = 400; // milliseconds until the first attempt to connect again; each further one waits twice as long
const LONGEST_WAIT = 4000;

/** @typedef {{type: string, [name: string]: any}} Message */

export class Live {
  /** @type {?WebSocket} */ #socket = null;
  #wait = FIRST_WAIT;
  #told;

  /**
   * @param {string} url
   * @param {{message: (m: Message) => void, bytes: (b: Blob) => void, connected: (is: boolean) => void}} told
   */
  constructor(url, told) {
    this.#told = told;
    this.#connect(url);
  }

  /**
   * Whether it could be sent.
   * @param {Message} message
   */
  send(message) {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  /** @param {string} url */
  #connect(url) {
    const socket = new WebSocket(url);
    this.#socket = socket;
    socket.addEventListener("open", () => {
      this.#wait = FIRST_WAIT;
      this.#told.connected(true);
    });
    socket.addEventListener("message", ({ data }) => {
      if (typeof data === "string") this.#told.message(JSON.parse(data));
      else this.#told.bytes(data);
    });
    socket.addEventListener("close", () => {
      this.#told.connected(false);
      setTimeout(() => this.#connect(url), this.#wait);
      this.#wait = Math.min(LONGEST_WAIT, 2 * this.#wait);
    });
  }
}
