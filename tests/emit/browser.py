"""A headless Chromium that draws into canvases, one after the other, and sends the pixels back."""

from __future__ import annotations

import itertools
import json
import os
import queue
import subprocess
import tempfile
import threading
from collections.abc import Iterator, Mapping
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from chromium import FLAGS, chromium
from emitting import ROOT

PATIENCE = 90.0  # seconds for a picture, its compiles by a software renderer included
_NODE = ROOT / "node_modules"

# `draw` is what a job's module exports: it returns the canvas' WebGL 2 context after drawing
_PAGE = """<!doctype html><meta charset="utf-8">
<script type="importmap">{"imports": {"three": "/node_modules/three/build/three.module.js"}}</script>
<script type="module">
async function done(job) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = job.size;
  const { draw } = await import(`/jobs/${job.number}/draw.js`);
  const gl = await draw(canvas);
  const bytes = new Uint8Array(4 * canvas.width * canvas.height);
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  const error = gl.getError();
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  if (error) throw new Error(`WebGL says ${error}`);
  return Array.from(bytes, b => b.toString(16).padStart(2, "0")).join("");
}
for (;;) {
  const job = await (await fetch("/next")).json();
  if (!job) continue;
  const told = { number: job.number, error: "", pixels: "" };
  try { told.pixels = await done(job); } catch (error) { told.error = String(error); }
  await fetch("/told", { method: "POST", body: JSON.stringify(told) });
}
</script>
"""

PLAIN = """
export function draw(canvas) {
  const gl = canvas.getContext("webgl2", { preserveDrawingBuffer: true, antialias: false });
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  for (const [name, value] of Object.entries(UNIFORMS)) {
    const place = gl.getUniformLocation(program, name);
    if (place) gl[`uniform${value.length}fv`](place, value);
  }
  if (GIVEN) {  // a texture of points, as wide as the canvas
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    const size = [canvas.width, canvas.height];
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, ...size, 0, gl.RGBA, gl.FLOAT, new Float32Array(GIVEN));
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  }
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  return gl;
}
"""
COVERING = """#version 300 es
void main() { gl_Position = vec4(vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0, 0.0, 1.0); }
"""

# The bits of a float as a colour: a canvas holds no floats.
_BITS = """
uniform highp sampler2D given_points;
layout(location = 0) out vec4 bits_out;
void main() {{
    vec3 p = texelFetch(given_points, ivec2(gl_FragCoord.xy), 0).xyz;
    uint bits = floatBitsToUint({call});
    bits_out = vec4(bits & 255u, (bits >> 8) & 255u, (bits >> 16) & 255u, bits >> 24) / 255.0;
}}
"""


def require_three() -> None:
    """three.js is under the repository, as npm installs it. Likewise."""
    if not (_NODE / "three").exists():
        if os.environ.get("SDFC_REQUIRE_GL") == "1":
            pytest.fail("SDFC_REQUIRE_GL=1, but three is not there: npm install --no-save three@0.180.0")
        pytest.skip("three is not there: npm install --no-save three@0.180.0")


def plain(fragment: str, uniforms: Mapping[str, Any], given: list[float] | None = None) -> str:
    """A module that draws a fragment shader over the canvas."""
    texts = {"VERTEX": COVERING, "FRAGMENT": fragment, "UNIFORMS": dict(uniforms), "GIVEN": given}
    return "".join(f"const {name} = {json.dumps(value)};\n" for name, value in texts.items()) + PLAIN


class Browser:
    """One process and one page for many jobs. It starts with the first, and anew after one that it did not answer."""

    def __init__(self) -> None:
        self._jobs: queue.Queue[dict[str, Any]] = queue.Queue()
        self._told: queue.Queue[dict[str, Any]] = queue.Queue()
        self._files: dict[str, str] = {"/": _PAGE}
        self._numbers = itertools.count()
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Handler, self._jobs, self._told, self._files))
        self._server.daemon_threads = True
        threading.Thread(target=self._server.serve_forever, daemon=True).start()
        self._process: subprocess.Popen[bytes] | None = None
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)

    def drawn(self, files: Mapping[str, str], size: tuple[int, int]) -> np.ndarray[Any, Any]:
        """(height, width, 4) bytes, rows from the top: what `draw.js` among the files draws."""
        self._start()
        number = next(self._numbers)
        self._files |= {f"/jobs/{number}/{name}": text for name, text in files.items()}
        self._jobs.put({"number": number, "size": size})
        try:
            told = self._told.get(timeout=PATIENCE)
        except queue.Empty:
            self._stop()
            raise AssertionError("the page said nothing") from None
        assert told["number"] == number and not told["error"], told["error"]
        width, height = size
        return np.frombuffer(bytes.fromhex(told["pixels"]), np.uint8).reshape(height, width, 4)[::-1]

    def values(self, text: str, call: str, points: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        """(n,) floats: the call, of a point `p`, in a shader that has the text; n is a multiple of 50."""
        size = (50, points.shape[1] // 50)
        rgba = np.concatenate([points, np.zeros((1, points.shape[1]))]).T.astype(np.float32)
        files = {"draw.js": plain(text + _BITS.format(call=call), {}, rgba.ravel().tolist())}
        return np.ascontiguousarray(self.drawn(files, size)[::-1]).reshape(-1, 4).view(np.float32)[:, 0]

    def _start(self) -> None:
        if self._process is not None:
            return
        page = f"http://127.0.0.1:{self._server.server_port}/"
        self._process = subprocess.Popen(
            [chromium(), *FLAGS, f"--user-data-dir={self._profile.name}", page],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def _stop(self) -> None:
        if self._process is not None:
            self._process.terminate()
            self._process.wait(20)
            self._process = None

    def close(self) -> None:
        self._stop()
        self._server.shutdown()
        self._server.server_close()
        self._profile.cleanup()


class _Handler(BaseHTTPRequestHandler):
    """Jobs to the page, answers from it, and files."""

    def __init__(self, jobs: queue.Queue[Any], told: queue.Queue[Any], files: Mapping[str, str], *given: Any) -> None:
        self._jobs, self._told, self._files = jobs, told, files
        super().__init__(*given)

    def do_GET(self) -> None:
        if self.path == "/next":
            self._send(json.dumps(self._next()), "application/json")
        elif self.path.startswith("/node_modules/three/build/"):
            self._send((_NODE / Path(self.path).relative_to("/node_modules")).read_text(), "text/javascript")
        elif self.path in self._files:
            self._send(self._files[self.path], "text/html" if self.path == "/" else "text/javascript")
        else:
            self.send_error(404)

    def _next(self) -> dict[str, Any] | None:
        try:
            made: dict[str, Any] = self._jobs.get(timeout=5.0)
        except queue.Empty:
            return None
        return made

    def do_POST(self) -> None:
        self._told.put(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
        self.send_response(204)
        self.end_headers()

    def _send(self, text: str, kind: str) -> None:
        data = text.encode()
        self.send_response(200)
        self.send_header("Content-Type", f"{kind}; charset=utf-8")
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def log_message(self, *_: Any) -> None:
        """Nothing: what is asked for is in the test."""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """A browser for the module's tests."""
    opened = Browser()
    yield opened
    opened.close()
