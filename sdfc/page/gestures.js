/** Mouse, fingers and wheel on the picture, as moves of the camera. */

/** Distances in heights of the picture. @typedef {{orbit: (right: number, up: number) => void,
 *   pan: (right: number, up: number) => void, zoom: (factor: number) => void, rest: () => void}} Moves */

const WHEEL = 0.0012; // a unit of the wheel, in natural logarithms of the distance
const PINCH = 0.01; // the same of a touchpad that pinches: browsers send it as a wheel with Ctrl
const LINE = 16; // units, where a wheel counts lines
const MOST_TURN = 240; // units that one turn counts for

/** @param {HTMLElement} stage @param {Moves} moves */
export function follow(stage, moves) {
  /** @type {Map<number, {x: number, y: number}>} where each finger, or the mouse, was last */
  const held = new Map();

  stage.addEventListener("pointerdown", (event) => {
    if (held.size >= 2) return;
    held.set(event.pointerId, { x: event.clientX, y: event.clientY });
    stage.setPointerCapture(event.pointerId);
  });
  stage.addEventListener("pointermove", (event) => {
    const before = held.get(event.pointerId);
    if (!before) return;
    const now = { x: event.clientX, y: event.clientY };
    const other = [...held].find(([id]) => id !== event.pointerId)?.[1];
    held.set(event.pointerId, now);
    const height = stage.clientHeight;
    const [right, up] = [(now.x - before.x) / height, (before.y - now.y) / height];
    if (other) {
      moves.zoom(Math.hypot(before.x - other.x, before.y - other.y) / Math.max(1, Math.hypot(now.x - other.x, now.y - other.y)));
      moves.pan(right / 2, up / 2);
    } else if (event.shiftKey || event.buttons & 6) moves.pan(right, up);
    else moves.orbit(right, up);
  });
  for (const end of /** @type {const} */ (["pointerup", "pointercancel"])) {
    stage.addEventListener(end, (event) => {
      if (held.delete(event.pointerId) && held.size === 0) moves.rest();
    });
  }
  stage.addEventListener("contextmenu", (event) => event.preventDefault());
  stage.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const units = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : LINE);
      const bounded = Math.min(MOST_TURN, Math.max(-MOST_TURN, units));
      moves.zoom(Math.exp(bounded * (event.ctrlKey ? PINCH : WHEEL)));
    },
    { passive: false },
  );
}
