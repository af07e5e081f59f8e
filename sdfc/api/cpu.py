"""Rendering with NumPy, in float64: for machines without OpenGL, and as the other opinion."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING

from sdfc.api.renderer import Buffer, Progress, Shot, jitter

if TYPE_CHECKING:
    from sdfc.plan.prove import Rays


class CpuRenderer:
    """Draws with sdfc.reference: much slower than OpenGL, the same picture within rounding."""

    @property
    def name(self) -> str:
        """What draws."""
        return "NumPy, float64"

    @property
    def rays(self) -> Rays:
        """Only the rays that meet a part's box pay for its formula, and every step of marching is many calls."""
        return "all"

    def radiance(self, shot: Shot, sample: int, progress: Progress | None) -> Buffer:
        """See Renderer."""
        from sdfc.pipeline import deep_recursion
        from sdfc.reference.render import radiance

        with deep_recursion():
            return radiance(shot.compiled, shot.view, shot.params, shot.size, jitter(sample), progress)

    def probe(self, shot: Shot, progress: Progress | None) -> list[Buffer]:
        """See Renderer."""
        from sdfc.pipeline import deep_recursion
        from sdfc.reference.render import probe

        with deep_recursion():
            return probe(shot.compiled, shot.view, shot.params, shot.size, progress)

    def depth(self, shot: Shot, progress: Progress | None) -> Buffer:
        """See Renderer."""
        return self.probe(shot, progress)[0]

    def kept_frames(self) -> AbstractContextManager[None]:
        """Holds none."""
        return nullcontext()

    def close(self) -> None:
        """Holds nothing."""
