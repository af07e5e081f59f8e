/** The keyboard: one table of what each key does, from which the help is made too. */

/** @typedef {{keys: string[], shown: string, words: string, run: (key: string) => void, shift?: boolean}} Shortcut */

/** The keys of the camera that scroll, choose and select elsewhere. */
const MOVES = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home"];

/**
 * Call what belongs to a key, but for those that what has the focus takes itself.
 * @param {Shortcut[]} shortcuts
 */
export function listen(shortcuts) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    const where = /** @type {HTMLElement} */ (event.target);
    if (where.matches("[type=number]") || (MOVES.includes(event.key) && isMovedIn(where))) return;
    const found = shortcuts.find(
      ({ keys, shift }) => keys.includes(event.key) && (shift === undefined || shift === event.shiftKey),
    );
    if (!found) return;
    event.preventDefault();
    found.run(event.key);
  });
}

/**
 * Whether arrows do something there: in what is chosen by them, can be selected, or lies in what scrolls.
 * @param {HTMLElement} where
 */
function isMovedIn(where) {
  if (where.matches("input, pre")) return true;
  /** @type {?HTMLElement} */ let around = where;
  for (; around && around !== document.body; around = around.parentElement) {
    if (getComputedStyle(around).overflowY === "auto" && around.scrollHeight > around.clientHeight) return true;
  }
  return false;
}

/**
 * Rows for the help.
 * @param {Shortcut[]} shortcuts
 * @param {HTMLTableSectionElement} table
 */
export function describe(shortcuts, table) {
  for (const { shown, words } of shortcuts) {
    const row = table.insertRow();
    const keys = row.insertCell();
    for (const key of shown.split(" "))
      keys.append(Object.assign(document.createElement("kbd"), { textContent: key }), " ");
    row.insertCell().textContent = words;
  }
}
