/** Colours: linear components in the scene, `#rrggbb` in the page (sRGB, IEC 61966-2-1). */

/**
 * @param {number} light
 * @returns {number}
 */
const encoded = (light) => (light <= 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055);

/**
 * @param {number} shown
 * @returns {number}
 */
const decoded = (shown) => (shown <= 0.04045 ? shown / 12.92 : ((shown + 0.055) / 1.055) ** 2.4);

/**
 * The nearest colour that a screen has.
 * @param {number[]} linear
 * @returns {string}
 */
export const hexOf = (linear) => `#${linear.map((c) => bytes(encoded(Math.min(1, Math.max(0, c))))).join("")}`;

/**
 * @param {string} hex
 * @returns {number[]}
 */
export const linearOf = (hex) => [1, 3, 5].map((at) => decoded(parseInt(hex.slice(at, at + 2), 16) / 255));

/**
 * The colour of a number in the view of materials: as `distinct` in templates/entry/inspect.frag.
 * @param {number} number
 */
export function distinctOf(number) {
  const hue = (0.618034 * number) % 1;
  return `#${[0, 2 / 3, 1 / 3].map((third) => bytes(0.6 + 0.3 * Math.cos(2 * Math.PI * (hue + third)))).join("")}`;
}

/** @param {number} share from 0 to 1 */
const bytes = (share) =>
  Math.round(255 * share)
    .toString(16)
    .padStart(2, "0");
