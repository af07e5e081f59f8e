/** What the colours of a view mean. */

import { distinctOf } from "./colour.js";

/** @typedef {import("./scene.js").Scene} Scene */

/** @type {Record<string, (scene: Scene) => (Node | string)[]>} */
const LEGENDS = {
  picture: () => [],
  depth: () => [bar("depth", ["near", "far"])],
  normals: () => [
    swatches([
      ["#ff8080", "x"],
      ["#80ff80", "y"],
      ["#8080ff", "z"],
    ]),
  ],
  steps: () => [bar("steps", ["0", "10", "127 or more"])],
  materials: (scene) => [swatches(scene.told.materials.map((name, number) => [distinctOf(number), name]))],
  server: () => [Object.assign(document.createElement("p"), { id: "served-state" })],
};

/**
 * @param {HTMLElement} place
 * @param {string} view
 * @param {Scene} scene
 */
export function explain(place, view, scene) {
  place.replaceChildren(...LEGENDS[view](scene));
}

/**
 * @param {string} name
 * @param {string[]} marks
 */
function bar(name, marks) {
  const figure = Object.assign(document.createElement("div"), { className: `scale ${name}` });
  figure.append(...marks.map((textContent) => Object.assign(document.createElement("span"), { textContent })));
  return figure;
}

/** @param {string[][]} colors pairs of a colour and what it stands for */
function swatches(colors) {
  const list = Object.assign(document.createElement("ul"), { className: "swatches" });
  for (const [color, textContent] of colors) {
    const item = Object.assign(document.createElement("li"), { textContent, title: textContent });
    item.style.setProperty("--color", color);
    list.append(item);
  }
  return list;
}
