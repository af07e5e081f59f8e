"""Where it went wrong, as a picture: what was drawn, in grey, and every ray that broke the guarantee in a colour."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sdfc.image.png import encode
from sdfc.measure.stress.trial import Trial

WIDTH = 640  # about as wide as the picture is made, in whole copies of its pixels

COLOURS = {  # sRGB
    "missed": (230, 30, 120),
    "false": (220, 30, 30),
    "early": (250, 150, 30),
    "late": (250, 220, 40),
    "given up": (40, 190, 230),
    "not a number": (160, 60, 240),
}
_VOID = (24, 26, 30)
_CONTESTED = (70, 90, 140)  # what the rays show where no answer is wrong, mixed in


def marked(trial: Trial) -> bytes:
    """A PNG. Contested rays have a blue tint; a ray with several faults shows the one that comes first in COLOURS."""
    picture = trial.picture
    facing = np.abs((picture.normal * picture.d).sum(axis=0))
    grey = 50.0 + 180.0 * np.sqrt(np.clip(np.nan_to_num(facing), 0.0, 1.0))
    pixels = np.where(picture.hit, grey, np.array(_VOID)[:, None].astype(float)).T.copy()
    contested = ~trial.sure
    pixels[contested] = 0.5 * pixels[contested] + 0.5 * np.array(_CONTESTED)
    for kind in reversed(COLOURS):
        pixels[trial.kinds[kind]] = COLOURS[kind]
    width, height = trial.size
    times = max(1, min(WIDTH // width, WIDTH // height))
    image: NDArray[np.uint8] = pixels.reshape(height, width, 3).astype(np.uint8)
    return encode(np.repeat(np.repeat(image, times, axis=0), times, axis=1))
