"""What tests of the page do again and again: look at the picture, wait for another one, copy the camera."""

from __future__ import annotations

from typing import Any

import numpy as np
from devtools import Tab, until

from sdfc.diagnostics import Source
from sdfc.pipeline import load
from sdfc.scene.model import Camera

Pixels = np.ndarray[Any, Any]

SIZE = (760, 330)  # of the window: the panel takes 288 of its width

# counts the programs that a page makes, and those that it has not given back
COUNTED = """{
  const made = { programs: 0, alive: 0 };
  const { createProgram, deleteProgram } = WebGL2RenderingContext.prototype;
  WebGL2RenderingContext.prototype.createProgram = function () {
    made.programs += 1;
    made.alive += 1;
    return createProgram.call(this);
  };
  WebGL2RenderingContext.prototype.deleteProgram = function (program) {
    made.alive -= program ? 1 : 0;
    return deleteProgram.call(this, program);
  };
  globalThis.counted = made;
}"""


def picture(tab: Tab) -> Pixels:
    """(height, width, 3): what is seen of the scene at rest, without the corner where a button lies."""
    tab.rest()
    return tab.seen("#view")[60:, :-60].astype(int)


def share_of_others(a: Pixels, b: Pixels, by: int = 8) -> float:
    """The share of pixels that differ by more than that."""
    assert a.shape == b.shape
    return float((np.abs(a - b).max(axis=-1) > by).mean())


def assert_alike(a: Pixels, b: Pixels) -> None:
    """The same but for edges, which one of the two may have smoothed."""
    off = np.abs(a - b).max(axis=-1)
    assert np.median(off) <= 1
    assert (off > 24).mean() < 0.03


def another(tab: Tab, before: Pixels) -> Pixels:
    """The picture that comes instead of the one before."""
    found: list[Pixels] = []

    def is_another() -> bool:
        found.append(picture(tab))
        return share_of_others(found[-1], before) > 0.005

    until(is_another, "another picture")
    return picture(tab)


def served(tab: Tab) -> Pixels:
    """The server's picture of what is seen now; the page goes back to its own."""
    tab.run("document.activeElement.blur()")
    tab.key("6")
    tab.until("document.querySelector('#served-state')?.textContent.startsWith('Drawn')")
    seen = picture(tab)
    tab.key("1")
    return seen


def copied(tab: Tab) -> Camera:
    """The camera as it was copied to the clipboard, in a scene."""
    tab.run("navigator.clipboard.writeText('nothing yet')")
    tab.key("c")
    text = tab.until("navigator.clipboard.readText().then(t => t.startsWith('camera') ? t : '')")
    scene = load(Source("copied.sdf", f"{text}\nscene {{ sphere(radius: 1) }}"))
    assert scene.camera is not None
    return scene.camera


def programs(tab: Tab) -> int:
    """How many were made so far; needs COUNTED."""
    return int(tab.run("counted.programs"))
