/** Mouse, fingers and wheel on the picture, as moves of the camera. */

/** Distances in heights of the picture. @typedef {{orbit: (right: number, up: number) => void,
 *   pan: (right: number, up: number) => void, zoom: (factor: number) => void, rest: () => void}} Moves */

/** In pixels of the page. @typedef {{x: number, y: number}} Place */

const NOT_THE_LEFT = 6; // the buttons of a mouse, as PointerEvent.buttons has them
const WHEEL = 0.0012; // a unit of the wheel, in natural logarithms of the distance
const PINCH = 0.01; // the same of a touchpad that pinches: browsers send it as a wheel with Ctrl
const LINE = 16; // units, where a wheel counts lines
const MOST_TURN = 240; // units that one turn counts for

/**
 * @param {HTMLElement} stage
 * @param {Moves} moves
 */
export function follow(stage, moves) {
  followPointers(stage, moves);
  stage.addEventListener("contextmenu", (event) => event.preventDefault());
  stage.addEventListener("wheel", (event) => turn(event, moves), { passive: false });
}

/**
 * @param {HTMLElement} stage
 * @param {Moves} moves
 */
function followPointers(stage, moves) {
  /** @type {Map<number, Place>} where each finger, or the mouse, was last */
  const held = new Map();

  stage.addEventListener("pointerdown", (event) => {
    if (held.size >= 2) return;
    held.set(event.pointerId, placeOf(event));
    stage.setPointerCapture(event.pointerId);
  });
  stage.addEventListener("pointermove", (event) => {
    const before = held.get(event.pointerId);
    if (!before) return;
    const now = placeOf(event);
    const other = [...held].find(([id]) => id !== event.pointerId)?.[1];
    held.set(event.pointerId, now);
    const right = (now.x - before.x) / stage.clientHeight;
    const up = (before.y - now.y) / stage.clientHeight;
    if (other) {
      moves.zoom(between(before, other) / between(now, other));
      moves.pan(right / 2, up / 2);
    } else if (event.shiftKey || event.buttons & NOT_THE_LEFT) moves.pan(right, up);
    else moves.orbit(right, up);
  });
  for (const end of /** @type {const} */ (["pointerup", "pointercancel"])) {
    stage.addEventListener(end, (event) => {
      if (held.delete(event.pointerId) && held.size === 0) moves.rest();
    });
  }
}

/**
 * @param {WheelEvent} event
 * @param {Moves} moves
 */
function turn(event, moves) {
  event.preventDefault();
  const units = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : LINE);
  const bounded = Math.min(MOST_TURN, Math.max(-MOST_TURN, units));
  moves.zoom(Math.exp(bounded * (event.ctrlKey ? PINCH : WHEEL)));
}

/**
 * @param {PointerEvent} event
 * @returns {Place}
 */
const placeOf = ({ clientX, clientY }) => ({ x: clientX, y: clientY });

/**
 * @param {Place} a
 * @param {Place} b
 */
const between = (a, b) => Math.max(1, Math.hypot(a.x - b.x, a.y - b.y));
