"""A headless Chromium that draws into a canvas and sends the pixels back."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Mapping
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from emitting import ROOT

PATIENCE = 60.0  # seconds for a page, its compiles by a software renderer included

# `draw` is a module that returns the canvas' WebGL 2 context after drawing
_PAGE = """<!doctype html><meta charset="utf-8"><canvas id="canvas" width="{width}" height="{height}"></canvas>
<script type="importmap">{{"imports": {{"three": "./three/build/three.module.js"}}}}</script>
<script type="module">
const told = {{ errors: [], pixels: "" }};
try {{
  const canvas = document.getElementById("canvas");
  const {{ draw }} = await import("./draw.js");
  const gl = await draw(canvas);
  const bytes = new Uint8Array(4 * canvas.width * canvas.height);
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  told.pixels = Array.from(bytes, b => b.toString(16).padStart(2, "0")).join("");
  if (gl.getError()) told.errors.push("an error of WebGL");
}} catch (error) {{
  told.errors.push(String(error));
}}
await fetch("/told", {{ method: "POST", body: JSON.stringify(told) }});
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
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  return gl;
}
"""
COVERING = """#version 300 es
void main() { gl_Position = vec4(vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0, 0.0, 1.0); }
"""


def chromium() -> str:
    """The browser. Without it the test is skipped, unless SDFC_REQUIRE_GL=1."""
    path = shutil.which("chromium")
    if path is None:
        if os.environ.get("SDFC_REQUIRE_GL") == "1":
            pytest.fail("SDFC_REQUIRE_GL=1, but chromium is not installed")
        pytest.skip("chromium is not installed")
    return path


def three() -> Path:
    """The folder of three.js as npm installs it, under the repository. Likewise."""
    folder = ROOT / "node_modules" / "three"
    if not folder.exists():
        if os.environ.get("SDFC_REQUIRE_GL") == "1":
            pytest.fail("SDFC_REQUIRE_GL=1, but three is not there: npm install --no-save three@0.180.0")
        pytest.skip("three is not there: npm install --no-save three@0.180.0")
    return folder


def plain(fragment: str, uniforms: Mapping[str, Any]) -> str:
    """A module that draws a fragment shader over the canvas."""
    texts = {"VERTEX": COVERING, "FRAGMENT": fragment, "UNIFORMS": dict(uniforms)}
    return "".join(f"const {name} = {json.dumps(value)};\n" for name, value in texts.items()) + PLAIN


def drawn(folder: Path, files: Mapping[str, str], size: tuple[int, int]) -> np.ndarray[Any, Any]:
    """(height, width, 4), rows from the top: what `draw.js` among the files draws."""
    page = _PAGE.format(width=size[0], height=size[1])
    for name, text in {**files, "index.html": page}.items():
        (folder / name).write_text(text)
    heard, done = {}, threading.Event()

    class Handler(SimpleHTTPRequestHandler):
        def do_POST(self) -> None:
            heard.update(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(204)
            self.end_headers()
            done.set()

        def log_message(self, *_: Any) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Handler, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        # ANGLE on Mesa: SwiftShader compiles large shaders for minutes
        flags = ["--headless", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=gl-egl"]
        flags += ["--ignore-gpu-blocklist", "--no-first-run", f"--user-data-dir={profile}"]
        browser = subprocess.Popen(
            [chromium(), *flags, f"http://127.0.0.1:{server.server_port}/index.html"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            assert done.wait(PATIENCE), "the page said nothing"
        finally:
            browser.terminate()
            browser.wait(20)
            server.shutdown()
            server.server_close()
    assert heard["errors"] == [], heard["errors"]
    width, height = size
    return np.frombuffer(bytes.fromhex(heard["pixels"]), np.uint8).reshape(height, width, 4)[::-1]
