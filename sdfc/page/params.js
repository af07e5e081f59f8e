/** A control for every param of the scene. */

import { hexOf, linearOf } from "./colour.js";
import { alike } from "./scene.js";

/** @typedef {import("./scene.js").Scene} Scene */
/** @typedef {import("./scene.js").Param} Param */

const DEGREES = 180 / Math.PI;
const AXES = ["x", "y", "z", "w"];

export class Params {
  #list;
  #template;
  #changed;
  #all;
  /** @type {?Scene} */ #scene = null;
  /** @type {(() => void)[]} bring a control up to date */ #updates = [];

  /**
   * @param {HTMLElement} list
   * @param {HTMLTemplateElement} template of a control: a name, a place for inputs, a button to reset
   * @param {HTMLElement} all the button that resets them all
   * @param {(isMoving: boolean) => void} changed
   */
  constructor(list, template, all, changed) {
    this.#list = list;
    this.#template = template;
    this.#all = all;
    this.#changed = changed;
    all.addEventListener("click", () => this.#reset());
  }

  /** @param {Scene} scene */
  show(scene) {
    const isSame = this.#scene !== null && alike(kinds(this.#scene), kinds(scene));
    this.#scene = scene;
    if (!isSame) {
      this.#updates = [];
      this.#list.replaceChildren(...scene.told.params.map((param) => this.#control(param)));
    }
    this.update();
  }

  /** Show the values that there are now. */
  update() {
    for (const update of this.#updates) update();
    this.#all.classList.toggle("unused", !this.#scene?.isTouched);
  }

  /** Every param back to the value in the text. */
  #reset() {
    for (const param of this.#scene?.told.params ?? []) this.#scene?.reset(param);
    this.update();
    this.#changed(false);
  }

  /** @param {Param} param */
  #control(param) {
    const control = /** @type {HTMLElement} */ (this.#template.content.cloneNode(true)).firstElementChild;
    const row = /** @type {HTMLElement} */ (control);
    const id = `param-${param.name}`;
    const label = /** @type {HTMLElement} */ (row.querySelector("legend"));
    label.textContent = param.name;
    const reset = /** @type {HTMLButtonElement} */ (row.querySelector("button"));
    reset.title = "Back to the value in the text";
    reset.setAttribute("aria-label", `Reset ${param.name}`);
    reset.addEventListener("click", () => {
      this.#scene?.reset(param);
      this.update();
      this.#changed(false);
    });
    this.#updates.push(() => reset.classList.toggle("unused", !this.#scene?.isSet(param)));
    this.#updates.push(() => (reset.disabled = !this.#scene?.isSet(param)));
    const inputs = /** @type {HTMLElement} */ (row.querySelector(".inputs"));
    if (param.unit === "color") inputs.append(this.#color(param, id));
    else inputs.append(...param.default.flatMap((_, index) => this.#number(param, id, index)));
    return row;
  }

  /**
   * @param {Param} param
   * @param {string} id
   */
  #color(param, id) {
    const input = made("input", { type: "color", id, ariaLabel: param.name });
    input.addEventListener("input", () => this.#set(param, linearOf(input.value), true));
    this.#updates.push(() => (input.value = hexOf(this.#value(param))));
    return input;
  }

  /**
   * A slider and a number for one component.
   * @param {Param} param
   * @param {string} id
   * @param {number} index
   */
  #number(param, id, index) {
    const scale = param.unit === "angle" ? DEGREES : 1;
    const low = (param.low ?? -1) * scale;
    const high = (param.high ?? 1) * scale;
    const places = Math.max(0, 3 - Math.floor(Math.log10(high - low)));
    const shown = (/** @type {number} */ x) => String(Number(x.toFixed(Math.min(20, places))));
    const ariaLabel = param.default.length > 1 ? `${param.name} ${AXES[index]}` : param.name;
    const ends = { min: shown(low), max: shown(high), ariaLabel };
    const slider = made("input", { type: "range", ...ends, step: "any", id: `${id}-${index}` });
    const number = made("input", { type: "number", ...ends, step: "any", id: `${id}-${index}-number` });
    const set = (/** @type {number} */ typed, /** @type {boolean} */ isMoving) => {
      const within = Math.min(param.high ?? Infinity, Math.max(param.low ?? -Infinity, typed / scale));
      this.#set(param, this.#value(param).with(index, within), isMoving);
    };
    slider.addEventListener("input", () => set(slider.valueAsNumber, true));
    slider.addEventListener("change", () => this.#changed(false));
    let isTyped = false; // and not yet taken
    number.addEventListener("input", () => (isTyped = true));
    number.addEventListener("blur", () => {
      isTyped = false;
      this.update();
    });
    number.addEventListener("change", () => {
      isTyped = false;
      if (Number.isFinite(number.valueAsNumber)) set(number.valueAsNumber, false);
      else this.update();
    });
    this.#updates.push(() => {
      const value = shown(this.#value(param)[index] * scale);
      if (slider.value !== value) slider.value = value;
      if (number.value !== value && !isTyped) number.value = value;
      const share = (Number(value) - low) / (high - low);
      slider.style.setProperty("--share", `${100 * Math.min(1, Math.max(0, share))}%`);
    });
    slider.addEventListener("keydown", (event) => step(event, slider, high - low));
    const amount = made("span", { className: `amount ${param.unit}` });
    amount.append(number);
    return [slider, amount];
  }

  /**
   * @param {Param} param
   * @returns {number[]}
   */
  #value(param) {
    return this.#scene?.valueOf(param) ?? param.default;
  }

  /**
   * @param {Param} param
   * @param {number[]} value
   * @param {boolean} isMoving
   */
  #set(param, value, isMoving) {
    this.#scene?.set(param, value);
    this.update();
    this.#changed(isMoving);
  }
}

/**
 * What controls there are, whatever they are set to.
 * @param {Scene} scene
 */
const kinds = (scene) => scene.told.params.map((param) => ({ ...param, default: param.default.length }));

/**
 * Arrows move a slider by a hundredth of its range, with Shift by a tenth: the browsers' own steps differ.
 * @param {KeyboardEvent} event
 * @param {HTMLInputElement} slider
 * @param {number} range
 */
function step(event, slider, range) {
  const sign = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
  if (!sign) return;
  event.preventDefault();
  slider.valueAsNumber += sign * range * (event.shiftKey ? 0.1 : 0.01);
  slider.dispatchEvent(new Event("input"));
}

/**
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} name
 * @param {object} properties
 * @returns {HTMLElementTagNameMap[T]}
 */
const made = (name, properties) => Object.assign(document.createElement(name), properties);
