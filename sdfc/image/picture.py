"""A rendered picture: its arrays, and the files that they can be kept in."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[Any]

AOVS = ("depth", "normal", "position", "material", "steps")
"""What can be kept beside the colour, by name."""

PICTURE_FORMATS = ("png", "exr", "npy")


@dataclass(frozen=True, slots=True, eq=False)
class Image:
    """A picture as NumPy arrays, rows from the top. Shows itself in a notebook.

    `colour` is linear radiance, float32 (height, width, 3); `aovs` has what else was asked for.
    """

    colour: NDArray[np.float32]
    aovs: Mapping[str, Array] = field(default_factory=dict)
    materials: tuple[str, ...] = ()
    """The names of the materials that `material` counts."""
    renderer: str = ""
    """What drew it: the device's name."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        height, width = self.colour.shape[:2]
        return width, height

    @property
    def depth(self) -> NDArray[np.float32]:
        """Distance along the ray, float32 (height, width), in the scene's units; infinity for a miss."""
        return self._aov("depth")

    @property
    def normal(self) -> NDArray[np.float32]:
        """Unit normal, outwards, float32 (height, width, 3); zero for a miss."""
        return self._aov("normal")

    @property
    def position(self) -> NDArray[np.float32]:
        """Where the ray hits, in the scene's coordinates, float32 (height, width, 3); NaN for a miss."""
        return self._aov("position")

    @property
    def material(self) -> NDArray[np.int32]:
        """Index into `materials`, int32 (height, width); -1 for a miss."""
        return self._aov("material")

    @property
    def steps(self) -> NDArray[np.int32]:
        """How many steps the tracer took, int32 (height, width)."""
        return self._aov("steps")

    def _aov(self, name: str) -> Array:
        if name not in self.aovs:
            raise AttributeError(f"{name} was not rendered; ask for it: render(aovs=['{name}'])")
        return self.aovs[name]

    @property
    def pixels(self) -> NDArray[np.uint8]:
        """What a screen shows: tone mapped, sRGB, uint8 (height, width, 3)."""
        from sdfc.shade.present import present

        return present(self.colour)

    def encode(self, file_format: str, quick: bool = False) -> bytes:
        """The picture as a file: `png` as a screen shows it, `exr` and `npy` as linear radiance.

        `quick` for a file that is soon replaced: it may be larger.
        """
        from sdfc.image import exr, npy, png

        if file_format == "png":
            return png.encode(self.pixels, png.QUICK if quick else png.SMALL)
        if file_format == "exr":
            return exr.encode({name: self.colour[..., index] for index, name in enumerate("RGB")})
        if file_format == "npy":
            return npy.encode(self.colour)
        raise ValueError(f"no picture format '{file_format}' (there are {', '.join(PICTURE_FORMATS)})")

    def encode_aov(self, name: str, file_format: str) -> bytes:
        """One of the other images as a file: `npy` and `exr` as it is, `png` so that it can be looked at."""
        from sdfc.image import exr, npy, png

        values = self._aov(name)
        if file_format == "npy":
            return npy.encode(values)
        if file_format == "exr":
            planes = {"Y": values} if values.ndim == 2 else {c: values[..., i] for i, c in enumerate("RGB")}
            return exr.encode(planes)
        if file_format == "png":
            return png.encode(_VISIBLE[name](values))
        raise ValueError(f"no picture format '{file_format}' (there are {', '.join(PICTURE_FORMATS)})")

    def save(self, path: str | Path) -> None:
        """Write the picture, whole or not at all; the name's ending says how."""
        from sdfc.image.write import write

        write(Path(path), self.encode(format_of(Path(path))))

    def _repr_png_(self) -> bytes:
        return self.encode("png")


def format_of(path: Path) -> str:
    """The picture format that a file's name asks for."""
    file_format = path.suffix.lower().removeprefix(".")
    if file_format not in PICTURE_FORMATS:
        endings = ", ".join(f".{known}" for known in PICTURE_FORMATS)
        raise ValueError(f"cannot tell the format of '{path}' by its ending (known: {endings})")
    return file_format


def _visible_depth(depth: Array) -> Array:
    """16 bits: the nearest is white, the farthest almost black, a miss black."""
    import numpy as np

    hit = np.isfinite(depth)
    if not hit.any():
        return np.zeros(depth.shape, np.uint16)
    near, far = depth[hit].min(), depth[hit].max()
    share = np.where(hit, depth - near, 0.0) / max(far - near, np.finfo(np.float32).tiny)
    return np.where(hit, 65535 - share * 60000, 0).astype(np.uint16)


def _visible_normal(normal: Array) -> Array:
    """8 bits: -1 .. 1 to 0 .. 255, as normal maps do."""
    import numpy as np

    return np.round((np.clip(normal, -1.0, 1.0) * 0.5 + 0.5) * 255).astype(np.uint8)


def _visible_position(position: Array) -> Array:
    """8 bits: the box of all hits, each axis to 0 .. 255; a miss is black."""
    import numpy as np

    hit = np.asarray(np.isfinite(position).all(axis=-1))
    if not np.any(hit):
        return np.zeros(position.shape, np.uint8)
    low, high = position[hit].min(axis=0), position[hit].max(axis=0)
    share = (position - low) / np.maximum(high - low, np.finfo(np.float32).tiny)
    return np.round(np.where(hit[..., None], share, 0.0) * 255).astype(np.uint8)


def _visible_material(material: Array) -> Array:
    """8 bits: a colour of its own for each of the first thousands of materials; a miss is black."""
    import numpy as np

    index = material.astype(np.int64)[..., None] + 1
    colours = (index * np.array([97, 57, 23]) * 7 + 64) % 192 + 64
    return np.where(index > 0, colours, 0).astype(np.uint8)


def _visible_steps(steps: Array) -> Array:
    """16 bits: the number of steps itself."""
    import numpy as np

    return np.clip(steps, 0, 65535).astype(np.uint16)


_VISIBLE: dict[str, Callable[[Array], Array]] = {
    "depth": _visible_depth,
    "normal": _visible_normal,
    "position": _visible_position,
    "material": _visible_material,
    "steps": _visible_steps,
}
