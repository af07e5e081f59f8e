/** What is told in words: errors over the last good picture, the state of the connection, short notices. */

const READ = 2600; // milliseconds that a notice stays

/**
 * @param {string} id
 * @returns {HTMLElement}
 */
export const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/**
 * Replace a text, if it is another: what is announced is announced once.
 * @param {string} id
 * @param {string} text
 */
export function write(id, text) {
  if (element(id).textContent !== text) element(id).textContent = text;
}

/** What can be wrong at a time, each for as long as it is: the scene, the browser's GPU. The first is shown.
 * @typedef {"scene" | "gpu"} Kind */

/** A text has its lines and carets. @typedef {{title: string, text: string}} Trouble */

/** @type {Record<Kind, ?Trouble>} */
const troubles = { scene: null, gpu: null };

/**
 * @param {Kind} kind
 * @param {?Trouble} trouble null where nothing is wrong any more
 */
export function problem(kind, trouble) {
  troubles[kind] = trouble;
  const shown = troubles.scene ?? troubles.gpu;
  element("problem").hidden = shown === null;
  if (!shown) return;
  write("problem-title", shown.title);
  write("problem-text", shown.text);
}

/** @param {boolean} isConnected */
export function connection(isConnected) {
  const place = element("connection");
  place.classList.toggle("lost", !isConnected);
  /** @type {HTMLElement} */ (place.querySelector(".words")).textContent = isConnected
    ? "Live"
    : "Connection lost, trying again";
}

/** @type {number | undefined} */
let timer;

/** @param {string} text */
export function notice(text) {
  write("toast", text);
  element("toast").classList.add("shown");
  clearTimeout(timer);
  timer = setTimeout(() => element("toast").classList.remove("shown"), READ);
}
