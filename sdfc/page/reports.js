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

/**
 * @param {string} title
 * @param {string} text with its lines and carets
 */
export function problem(title, text) {
  const section = element("problem");
  /** @type {HTMLElement} */ (section.querySelector("h2")).textContent = title;
  /** @type {HTMLElement} */ (section.querySelector("pre")).textContent = text;
  section.hidden = false;
}

/** Nothing is wrong any more. */
export function well() {
  element("problem").hidden = true;
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
