/** The keyboard: one table of what each key does, from which the help is made too. */

/** @typedef {{keys: string[], shown: string, words: string, run: (key: string) => void, shift?: boolean}} Shortcut */

const MOVES = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home"];

/**
 * Call what belongs to a key, but for those that what has the focus takes itself.
 * @param {Shortcut[]} shortcuts
 */
export function listen(shortcuts) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    const where = /** @type {HTMLElement} */ (event.target);
    if (where.matches("[type=number]") || (where.matches("input") && MOVES.includes(event.key))) return;
    const found = shortcuts.find(
      ({ keys, shift }) => keys.includes(event.key) && (shift === undefined || shift === event.shiftKey),
    );
    if (!found) return;
    event.preventDefault();
    found.run(event.key);
  });
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
