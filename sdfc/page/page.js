/** The page of `sdfc watch --serve`: its parts, put together. */

import { Bounds } from "./bounds.js";
import { orbited, panned, textOf, zoomed } from "./camera.js";
import { follow } from "./gestures.js";
import { describe, listen } from "./keys.js";
import { explain } from "./legend.js";
import { Live } from "./live.js";
import { Painter } from "./painter.js";
import { Params } from "./params.js";
import { connection, element, notice, problem, write } from "./reports.js";
import { alike, Scene } from "./scene.js";
import { Served } from "./served.js";

/** @typedef {import("./camera.js").Camera} Camera */

const VIEWS = ["picture", "depth", "normals", "steps", "materials", "server"];
const TURN = Math.PI; // a drag over the picture's height
const KEY_TURN = Math.PI / 24;
const KEY_PAN = 0.05; // of the picture's height
const KEY_ZOOM = 1.15;

class Page {
  /** @type {?Scene} */ #scene = null;
  /** @type {?Camera} */ #camera = null;
  #view = "picture";
  #painter = new Painter(/** @type {HTMLCanvasElement} */ (element("picture")), {
    troubled: () => this.#warn(),
    changed: (isBusy) => this.#tell(isBusy),
  });
  #bounds = new Bounds(/** @type {HTMLCanvasElement} */ (element("bounds")));
  #params = new Params(
    element("controls"),
    /** @type {HTMLTemplateElement} */ (element("control")),
    element("reset-all"),
    (isMoving) => this.#changed(isMoving),
  );
  #live = new Live(`ws://${location.host}/live`, {
    message: (message) => this.#heard(message),
    bytes: (bytes) => void this.#served.take(bytes),
    connected: (isConnected) => {
      connection(isConnected);
      this.#served.connected(isConnected);
    },
  });
  #served = new Served(
    /** @type {HTMLImageElement} */ (element("served")),
    (message) => this.#live.send(message),
    (state, text) => served(state, text),
  );

  constructor() {
    follow(element("view"), {
      orbit: (right, up) => this.#move((camera) => orbited(camera, -TURN * right, -TURN * up)),
      pan: (right, up) => this.#move((camera) => panned(camera, -right, -up)),
      zoom: (factor) => this.#zoom(factor),
      rest: () => this.#changed(false),
    });
    const shortcuts = this.#shortcuts();
    listen(shortcuts);
    describe(shortcuts, /** @type {HTMLTableSectionElement} */ (element("shortcuts")));
    this.#listen();
    new ResizeObserver(() => this.#resized()).observe(element("view"));
    addEventListener("resize", () => this.#resized()); // also where only the pixels of the device are others
    if (!this.#painter.isAble) this.#turnTo("server");
  }

  /** @param {import("./live.js").Message} message */
  #heard(message) {
    switch (message.type) {
      case "scene":
        return this.#take(/** @type {any} */ (message));
      case "values":
        problem("scene", null);
        this.#scene?.follow(/** @type {any} */ (message));
        this.#params.update();
        return this.#changed(false);
      case "boxes":
        this.#scene?.place(/** @type {any} */ (message));
        return this.#bounds.draw(this.#scene, this.#camera, this.#size);
      case "camera":
        problem("scene", null);
        return this.#goTo(message.camera);
      case "errors":
        return problem("scene", {
          title: message.diagnostics.length > 1 ? `${message.diagnostics.length} errors` : "Error",
          text: message.text,
        });
      case "well":
        return problem("scene", null);
      case "note":
        return write("note", message.text);
      case "picture":
        return this.#served.announce(message.request);
      case "refused":
        return this.#served.refused(message.request, message.text);
    }
  }

  /** @param {import("./scene.js").Told} told */
  #take(told) {
    problem("scene", null);
    const before = this.#scene?.told.title === told.title ? this.#scene : null; // or a server of another scene
    this.#scene = new Scene(told, before);
    element("waiting").hidden = true;
    element("params").hidden = told.params.length === 0;
    document.title = `${told.title} · sdfc`;
    write("title", told.title);
    write("tracer", told.tracer);
    element("tracer").title = told.guarantee;
    this.#params.show(this.#scene);
    explain(element("legend"), this.#view, this.#scene);
    this.#painter.show(this.#scene);
    this.#warn();
    // who moved the camera stays there, until the text says something else
    if (!before || !alike(before.told.camera, told.camera)) this.#goTo(told.camera);
    else this.#renew();
  }

  /**
   * To a camera that the text says.
   * @param {Camera} camera
   */
  #goTo(camera) {
    if (this.#scene) this.#scene.told.camera = camera;
    this.#camera = camera;
    this.#changed(false);
  }

  /** @param {(camera: Camera) => Camera} moved */
  #move(moved) {
    if (!this.#camera) return;
    this.#camera = moved(this.#camera);
    this.#changed(true);
  }

  /** @param {number} factor */
  #zoom(factor) {
    this.#move((camera) => zoomed(camera, factor, this.#scene?.told.own.radius ?? 1));
  }

  #home() {
    if (this.#scene) this.#goTo(this.#scene.told.camera);
  }

  /**
   * Draw what there is now.
   * @param {boolean} isMoving
   */
  #changed(isMoving) {
    if (!this.#scene || !this.#camera) return;
    this.#painter.look(this.#camera, isMoving);
    this.#renew();
  }

  /** What lies over the picture. */
  #renew() {
    if (!this.#scene || !this.#camera) return;
    this.#bounds.draw(this.#scene, this.#camera, this.#size);
    this.#served.want({ camera: this.#camera, params: this.#scene.params, size: this.#size });
  }

  /** @param {string} view */
  #turnTo(view) {
    this.#view = view;
    const radio = /** @type {HTMLInputElement} */ (document.querySelector(`#views [value=${view}]`));
    radio.checked = true;
    this.#served.isOn = view === "server";
    if (this.#scene) explain(element("legend"), view, this.#scene);
    this.#painter.turnTo(/** @type {import("./painter.js").View} */ (view === "server" ? "picture" : view));
    this.#warn();
    this.#changed(false);
  }

  /** Say what the browser's GPU cannot do, but where it is not asked to. */
  #warn() {
    problem("gpu", this.#view === "server" ? null : this.#painter.trouble);
  }

  #toggleBounds() {
    this.#bounds.isShown = !this.#bounds.isShown;
    /** @type {HTMLInputElement} */ (element("show-bounds")).checked = this.#bounds.isShown;
    this.#bounds.draw(this.#scene, this.#camera, this.#size);
  }

  #togglePanel() {
    const isHidden = document.body.classList.toggle("bare");
    element("toggle").setAttribute("aria-expanded", String(!isHidden));
    element("panel").inert = isHidden;
  }

  async #save() {
    if (!this.#scene) return; // or the first picture would save itself when it comes
    const isServed = this.#view === "server";
    const blob = await (isServed ? this.#served.saved() : this.#painter.saved());
    if (!blob) return notice("There is no picture to save");
    const view = isServed ? "server" : this.#painter.view; // a painter's is of the view that it draws by then
    const stem = this.#scene.told.title.replace(/\.[^.]*$/, "");
    const link = document.createElement("a");
    link.download = view === "picture" ? `${stem}.png` : `${stem}-${view}.png`;
    link.href = URL.createObjectURL(blob);
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    notice(`Saved ${link.download}`);
  }

  async #copy() {
    if (!this.#camera) return;
    const text = textOf(this.#camera);
    try {
      await navigator.clipboard.writeText(text);
      notice("Camera copied");
    } catch {
      notice(text); // a browser that lets no page write to the clipboard
    }
  }

  #resized() {
    if (this.#painter.resize(this.#size)) this.#changed(false);
  }

  /**
   * Of the picture, in pixels of the device.
   * @returns {[number, number]}
   */
  get #size() {
    const { width, height } = element("view").getBoundingClientRect();
    return [Math.round(width * devicePixelRatio), Math.round(height * devicePixelRatio)];
  }

  /** @param {boolean} isBusy */
  #tell(isBusy) {
    element("view").setAttribute("aria-busy", String(isBusy));
    const { milliseconds, size } = this.#painter.speed;
    if (!isBusy) write("speed", `${size[0]} × ${size[1]}, ${Math.max(1, Math.round(milliseconds))} ms`);
  }

  #listen() {
    element("views").addEventListener("change", (event) =>
      this.#turnTo(/** @type {HTMLInputElement} */ (event.target).value),
    );
    element("show-bounds").addEventListener("change", () => this.#toggleBounds());
    element("toggle").addEventListener("click", () => this.#togglePanel());
    element("home").addEventListener("click", () => this.#home());
    element("copy").addEventListener("click", () => void this.#copy());
    element("save").addEventListener("click", () => void this.#save());
    element("ask").addEventListener("click", () => this.#help());
  }

  #help() {
    /** @type {HTMLDialogElement} */ (element("help")).showModal();
  }

  /** @returns {import("./keys.js").Shortcut[]} */
  #shortcuts() {
    const arrow = (/** @type {string} */ key) => [
      Number(key === "ArrowRight") - Number(key === "ArrowLeft"),
      Number(key === "ArrowUp") - Number(key === "ArrowDown"),
    ];
    const orbit = (/** @type {string} */ key) => {
      const [right, up] = arrow(key);
      this.#move((camera) => orbited(camera, KEY_TURN * right, KEY_TURN * up));
    };
    const pan = (/** @type {string} */ key) => {
      const [right, up] = arrow(key);
      this.#move((camera) => panned(camera, KEY_PAN * right, KEY_PAN * up));
    };
    const arrows = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"];
    return [
      { keys: arrows, shift: false, shown: "← → ↑ ↓", words: "Orbit", run: orbit },
      { keys: arrows, shift: true, shown: "Shift ← → ↑ ↓", words: "Pan", run: pan },
      { keys: ["+", "="], shown: "+", words: "Nearer", run: () => this.#zoom(1 / KEY_ZOOM) },
      { keys: ["-", "_"], shown: "−", words: "Farther", run: () => this.#zoom(KEY_ZOOM) },
      { keys: ["Home"], shown: "Home", words: "Reset the view", run: () => this.#home() },
      {
        keys: ["1", "2", "3", "4", "5", "6"],
        shown: "1 … 6",
        words: "Views",
        run: (key) => this.#turnTo(VIEWS[Number(key) - 1]),
      },
      { keys: ["b", "B"], shown: "B", words: "Bounds", run: () => this.#toggleBounds() },
      { keys: ["s", "S"], shown: "S", words: "Save the picture", run: () => void this.#save() },
      { keys: ["c", "C"], shown: "C", words: "Copy the camera", run: () => void this.#copy() },
      { keys: ["h", "H"], shown: "H", words: "Hide or show the controls", run: () => this.#togglePanel() },
      { keys: ["?"], shown: "?", words: "This help", run: () => this.#help() },
    ];
  }
}

/**
 * @param {import("./served.js").State} state
 * @param {string} text
 */
function served(state, text) {
  const words = {
    asked: "sdfc is drawing…",
    shown: "Drawn by sdfc, not by this browser",
    refused: text,
    lost: "Connection lost: asks again when it is back",
  };
  if (document.getElementById("served-state")) write("served-state", words[state]);
}

new Page();
