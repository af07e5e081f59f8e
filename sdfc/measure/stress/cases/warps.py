"""Space bent, copied, and covered with detail; and scenes that are deep."""

from __future__ import annotations

from sdfc.measure.stress.record import Case, Family, look, scene

_CORNER = look((2.3, 1.9, 2.9))
_RATES = (0.0, 1.0, 30.0, 90.0, 360.0, 1440.0)  # degrees per length

_REPEATED = {
    "a corner of each cell": "sphere(radius: 0.1).translate([0.2, 0.2, 0.2])"
    ".repeat(spacing: [0.5, 0.5, 0.5], count: [4, 4, 4])",
    "across the cell's wall": "box(size: [0.2, 0.2, 0.2]).translate([0.25, 0, 0])"
    ".repeat(spacing: [0.5, 0.5, 0.5], count: [4, 3, 1])",
    "wider than a cell": "capsule(from: [-0.4, 0, 0], to: [0.4, 0, 0], radius: 0.08)"
    ".repeat(spacing: [0.5, 0.5, 0.5], count: [3, 4, 3])",
    "an even and an odd count": "box(size: [0.3, 0.2, 0.25]).translate([0.05, 0.1, 0])"
    ".repeat(spacing: [0.4, 0.5, 0.6], count: [4, 3, 1])",
    "no distance": "ellipsoid(radii: [0.2, 0.1, 0.05]).translate([0.1, 0, 0])"
    ".repeat(spacing: [0.5, 0.4, 0.3], count: [3, 3, 3])",
    "without end": "sphere(radius: 0.15).translate([0.1, 0.2, 0])"
    ".repeat(spacing: [0.6, 0.6, 0.6]) & sphere(radius: 1.2)",
    "mirrored": "sphere(radius: 0.2).translate([0.3, 0.1, 0])"
    ".mirror_repeat(spacing: [0.6, 0.6, 0.6]) & sphere(radius: 1.2)",
    "around an axis": "box(size: [0.2, 0.5, 0.2]).translate([0.7, 0, 0.3]).polar_repeat(count: 7)",
    "in a kaleidoscope": "box(size: [0.4, 0.5, 0.2]).translate([0.6, 0, 0.3]).mirror_polar_repeat(count: 8)",
}

_DETAILED = {
    "gyroid": "gyroid(period: {p}, thickness: {t}) & box(size: [1, 1, 1])",
    "diamond": "diamond(period: {p}, thickness: {t}) & sphere(radius: 0.7)",
    "displaced": "sphere(radius: 0.6).displace(amplitude: {t}, wavelength: {p})",
    "waves": "waves(amplitude: {t}, wavelength: {p}) & box(size: [1.4, 1.4, 1.4])",
    "layers": "sphere(radius: 0.6).onion(thickness: {t}, spacing: {p}, layers: 4)"
    " - box(size: [2, 2, 2]).translate([1, 1, 1])",
}
_PERIODS = (0.4, 0.1, 0.03)


def _warped(name: str, solid: str) -> tuple[Case, ...]:
    return tuple(
        Case(name=f"{name}, {rate:g} degrees", text=scene(solid.format(rate=f"{rate!r}deg")), view=_CORNER)
        for rate in _RATES
    )


def _union(count: int) -> str:
    """Each union within the next one, of balls that come again and again."""
    text = "box(size: [1, 0.8, 0.9])"
    for i in range(count):
        text = f"({text} | sphere(radius: {0.3 + 0.02 * (i % 8):.2f}).translate([{0.1 * (i % 8):.1f}, 0.4, 0.3]))"
    return text


def _by_turns(count: int) -> str:
    """A tree as deep as it has operations: united and cut by turns, by solids that come again and again."""
    text = "box(size: [1, 0.8, 0.9])"
    for i in range(count):
        if i % 2:
            text = f"({text} - sphere(radius: {0.3 + 0.02 * (i % 8):.2f}).translate([{0.1 * (i % 8):.1f}, 0.4, 0.3]))"
        else:
            text = f"({text} | box(size: [{1.2 - 0.1 * (i % 6):.1f}, {0.2 + 0.1 * (i % 6):.1f}, 0.5]))"
    return text


def _cuts(count: int) -> str:
    text = "box(size: [1.6, 1.6, 1.6])"
    for i in range(count):
        place = f"[{0.618 * i % 1 * 1.8 - 0.9:.4f}, {0.414 * i % 1 * 1.8 - 0.9:.4f}, 0.8]"
        text = f"({text} - cylinder(radius: 0.04, height: 0.4).rotate(x: 90deg).translate({place}))"
    return text


def _turns(count: int) -> str:
    return "box(size: [1, 0.6, 0.3])" + "".join(
        f".rotate({axis}: {7 + i % 5}deg).translate([{0.001 * (i % 3):.3f}, 0, 0])"
        for i in range(count)
        for axis in "xyz"[i % 3]
    )


def _complements(count: int) -> str:
    return "~" * count + "(box(size: [1, 1, 1]) - sphere(radius: 0.6))"


def _blended(count: int) -> str:
    text = "sphere(radius: 0.2).translate([-0.8, 0, 0])"
    for i in range(1, count):
        text = (
            f"union(blend: 0.1) {{ {text} sphere(radius: 0.15).translate"
            f"([{1.6 * i / count - 0.8:.4f}, {0.3 * (i % 3) - 0.3:.2f}, {0.2 * (i % 2):.2f}]) }}"
        )
    return text


FAMILIES = (
    Family(
        name="repeat",
        doc="Copies of what is not in the middle of its cell: the nearest cell is not the nearest copy.",
        cases=tuple(Case(name=name, text=scene(solid), view=_CORNER) for name, solid in _REPEATED.items()),
    ),
    Family(
        name="twist",
        doc="Warps from none to four turns a length: fields ever steeper, and ever farther from a distance.",
        cases=_warped("twisted bar", "box(size: [0.5, 1.2, 0.3]).twist({rate})")
        + _warped(
            "twisted pillar off the axis", "cylinder(radius: 0.15, height: 1.2).translate([0.4, 0, 0]).twist({rate})"
        )
        + _warped("bent bar", "box(size: [1.4, 0.2, 0.3]).bend({rate})"),
    ),
    Family(
        name="detail",
        doc="Fields with far more detail than pixels.",
        cases=tuple(
            Case(name=f"{name} of {p:g}", text=scene(solid.format(p=repr(p), t=repr(0.08 * p))), view=_CORNER)
            for name, solid in _DETAILED.items()
            for p in _PERIODS
        ),
    ),
    Family(
        name="deep",
        doc="Chains of a thousand operations.",
        cases=(
            Case(name="united 1000 times", text=scene(_union(1000)), view=_CORNER),
            Case(name="united and cut 200 times by turns", text=scene(_by_turns(200)), view=_CORNER),
            Case(name="a box less 24 holes, one by one", text=scene(_cuts(24)), view=look((1.2, 1.0, 3.2))),
            Case(name="1000 moves", text=scene(_turns(500)), view=_CORNER),
            Case(name="1000 complements", text=scene(_complements(1000)), view=_CORNER),
            Case(name="a blend of 12 blends", text=scene(_blended(12)), view=_CORNER),
        ),
    ),
)
