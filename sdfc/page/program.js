/** A shader program that compiles while others draw. */

/** @typedef {import("./scene.js").Scene} Scene */

const COVERING = `#version 300 es
void main() { gl_Position = vec4(vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0, 0.0, 1.0); }
`;

export class Program {
  #gl;
  #parallel;
  #made;
  /** @type {WebGLShader[]} */ #shaders;
  /** @type {?Map<string, {place: WebGLUniformLocation, isWhole: boolean}>} */ #uniforms = null;

  /**
   * Begins to compile.
   * @param {WebGL2RenderingContext} gl
   * @param {string} fragment
   */
  constructor(gl, fragment) {
    this.#gl = gl;
    this.#parallel = gl.getExtension("KHR_parallel_shader_compile");
    this.#made = /** @type {WebGLProgram} */ (gl.createProgram());
    this.#shaders = [this.#shader(gl.VERTEX_SHADER, COVERING), this.#shader(gl.FRAGMENT_SHADER, fragment)];
    gl.linkProgram(this.#made);
  }

  /**
   * @param {number} kind
   * @param {string} text
   */
  #shader(kind, text) {
    const gl = this.#gl;
    const shader = /** @type {WebGLShader} */ (gl.createShader(kind));
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(this.#made, shader);
    return shader;
  }

  /** Whether the driver is done; to ask does not wait, where the browser can tell. */
  get isDone() {
    const parallel = this.#parallel;
    return parallel === null || this.#gl.getProgramParameter(this.#made, parallel.COMPLETION_STATUS_KHR) === true;
  }

  /**
   * What the driver has against the shader; empty if nothing. To be asked once it is done.
   * @returns {string}
   */
  get complaint() {
    const gl = this.#gl;
    if (gl.getProgramParameter(this.#made, gl.LINK_STATUS) || gl.isContextLost()) return "";
    const logs = this.#shaders.map((shader) => gl.getShaderInfoLog(shader));
    return [...logs, gl.getProgramInfoLog(this.#made)].filter(Boolean).join("\n") || "the shader cannot be compiled";
  }

  /**
   * Draw over everything that is bound. Uniforms that it has not are passed over.
   * @param {Record<string, number[]>} values
   */
  draw(values) {
    const gl = this.#gl;
    gl.useProgram(this.#made);
    for (const [name, { place, isWhole }] of (this.#uniforms ??= this.#found())) {
      const value = values[name];
      if (!value) continue;
      if (isWhole) gl.uniform1i(place, value[0]);
      else if (value.length === 1) gl.uniform1f(place, value[0]);
      else if (value.length === 2) gl.uniform2fv(place, value);
      else if (value.length === 3) gl.uniform3fv(place, value);
      else gl.uniform4fv(place, value);
    }
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  #found() {
    const gl = this.#gl;
    const found = new Map();
    for (let i = 0; i < gl.getProgramParameter(this.#made, gl.ACTIVE_UNIFORMS); i++) {
      const info = /** @type {WebGLActiveInfo} */ (gl.getActiveUniform(this.#made, i));
      const isWhole = info.type === gl.INT || info.type === gl.SAMPLER_2D;
      found.set(info.name, { place: gl.getUniformLocation(this.#made, info.name), isWhole });
    }
    return found;
  }

  /** Give it back to the driver. */
  delete() {
    for (const shader of this.#shaders) this.#gl.deleteShader(shader);
    this.#gl.deleteProgram(this.#made);
  }
}
