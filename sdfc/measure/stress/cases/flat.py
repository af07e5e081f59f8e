"""Fields that say little of how near the surface is: flat where they are zero, or far from it."""

from __future__ import annotations

from sdfc.measure.stress.record import Case, Family, look, parallel, scene

_BOX = "bounds -[1, 1, 1] .. [1, 1, 1]"
_BALL = "d = length(p) - 0.5"

_FIELDS = {  # by what is hard: a formula in p, in a box of side 2 or one of its own
    "a ball, squared": f"d * abs(d) where {_BALL}",
    "a ball, cubed": f"d * d * d where {_BALL}",
    "a ball, in thousandths": "0.001 * (length(p) - 0.5)",
    "a ball of fourth powers": "dot(p, p) * dot(p, p) - 0.01",
    "a block of eighth powers": "q.x * q.x + q.y * q.y + q.z * q.z - 0.0001"
    " where s = p * p, t = s * s, q = [t.x * t.x, t.y * t.y, t.z * t.z]",
    "two balls, multiplied": "(length(p - [0.2, 0, 0]) - 0.4) * (length(p + [0.2, 0, 0]) - 0.4)",
    "a ball that levels off": f"d / (1 + 4 * abs(d)) where {_BALL} bounds -[r, r, r] .. [r, r, r]"
    " where r = 0.5 + level / (1 - 4 * level)",
    "a ball that is flat half-way": f"d * (0.001 + (d - 0.2) * (d - 0.2)) where {_BALL}",
    "a ball that is steep behind": f"d + 40 * min(d + 0.3, 0) where {_BALL}",
}

_CUT = "flat() - box(size: [2, 2, 2]).translate([1, 1, 1])"
_BLENDED = "union(blend: 0.05) { flat() sphere(radius: 0.3).translate([0.4, 0.3, 0.3]) }"
_LEVEL = frozenset({"a ball, squared", "a ball, cubed"})  # of no slope at all where they are zero: seen by themselves

_TOP = {"a ball of fourth powers": 0.316, "a block of eighth powers": 0.316, "two balls, multiplied": 0.39}  # or 0.5
_CORNER = look((2.3, 1.9, 2.9))


def _flat(name: str, formula: str) -> tuple[Case, ...]:
    field = f"field flat() = {formula} {'' if 'bounds' in formula else _BOX}"
    top = _TOP.get(name, 0.5)
    views = {
        "": _CORNER,
        " from far away": look((230.0, 190.0, 290.0), fov=0.006),
        " along the top": parallel((0.1, top, 4.0), (0.1, top, 0.0), 0.2),
    }
    more = {} if name in _LEVEL else {" cut": _CUT, " in a blend": _BLENDED}
    return tuple(
        Case(name=f"{name}{way}", text=scene("flat()", before=field), view=view) for way, view in views.items()
    ) + tuple(Case(name=f"{name}{way}", text=scene(solid, before=field), view=_CORNER) for way, solid in more.items())


FAMILIES = (
    Family(
        name="flat",
        doc="Fields that hardly change at their surface, or on the way to it: their values are no distances.",
        cases=tuple(case for name, formula in _FIELDS.items() for case in _flat(name, formula)),
    ),
)
