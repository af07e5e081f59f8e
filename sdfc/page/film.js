/** What samples are added up on, and shown from: one texture of the picture's size or less. */

import { Program } from "./program.js";

const DEVELOP = `#version 300 es
precision highp float;
uniform sampler2D sum;
uniform vec4 scale;  // of places, 2 numbers; 1 / samples
out vec4 color;
void main() { color = vec4(texture(sum, gl_FragCoord.xy * scale.xy).rgb * scale.z, 1.0); }
`;

export class Film {
  #gl;
  #texture;
  #target;
  #develop;
  /** @type {[number, number]} */ #size = [0, 0];

  /** @param {WebGL2RenderingContext} gl */
  constructor(gl) {
    this.#gl = gl;
    this.isDeep = gl.getExtension("EXT_color_buffer_float") !== null; // whether more than one sample can be added
    this.#texture = gl.createTexture();
    this.#target = gl.createFramebuffer();
    this.#develop = new Program(gl, DEVELOP);
    gl.blendFunc(gl.ONE, gl.ONE);
  }

  /**
   * Draw on some rows.
   * @param {[number, number]} size of the whole
   * @param {{first: number, count: number}} rows
   * @param {boolean} isFirst whether to begin anew
   * @param {() => void} draw
   */
  expose(size, rows, isFirst, draw) {
    const gl = this.#gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.#target);
    if (size[0] !== this.#size[0] || size[1] !== this.#size[1]) this.#resize(size);
    gl.viewport(0, 0, size[0], size[1]);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(0, rows.first, size[0], rows.count);
    if (isFirst) gl.disable(gl.BLEND);
    else gl.enable(gl.BLEND);
    draw();
    gl.disable(gl.BLEND);
    gl.disable(gl.SCISSOR_TEST);
  }

  /**
   * Show it on the canvas.
   * @param {number} samples that were added up
   */
  show(samples) {
    const gl = this.#gl;
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, width, height);
    gl.bindTexture(gl.TEXTURE_2D, this.#texture);
    this.#develop.draw({ sum: [0], scale: [1 / width, 1 / height, 1 / samples, 0] });
  }

  /** @param {[number, number]} size */
  #resize(size) {
    const gl = this.#gl;
    this.#size = size;
    gl.bindTexture(gl.TEXTURE_2D, this.#texture);
    if (this.isDeep) gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA16F, ...size, 0, gl.RGBA, gl.HALF_FLOAT, null);
    else gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, ...size, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.#texture, 0);
  }
}
