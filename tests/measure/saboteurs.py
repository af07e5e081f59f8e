"""Tracers that are wrong, each in its own way: what `sdfc stress` is tested on. GLSL, as in templates/trace."""

from __future__ import annotations

from dataclasses import dataclass

from sdfc.tracers.record import Tracer

_HEAD = "float trace(vec3 o, vec3 d, float start, float limit) {\n"
_END = '    float end = min(limit, {{ "1.0001 - dot(o, d)" if finite else horizon }});\n'


def _sphere(point: str = "o + t * d", radius: str = "map(p)", eps: str = "tolerance(t)", step: str = "r") -> str:
    """Sphere tracing, with one of its parts replaced."""
    return f"""{_HEAD}    float t = start, r, eps;
{_END}    int count = 0;
    do {{
        vec3 p = {point};
        r = {radius};
        eps = {eps};
        t += r > eps ? {step} : 0.0;
        steps += 1.0;
        count += 1;
    }} while (!(r <= eps) && t < end && count < MOST_STEPS);
    unfinished = !(r <= eps) && t < end ? 1.0 : 0.0;
    return t < end ? t : FAR;
}}
"""


# Keinert et al. 2014, listing 2: it looks for the far plane before it looks whether the step was sound
_PAST_THE_END = f"""{_HEAD}    float t = start, r = map(o + t * d), z = r;
{_END}    int count = 0;
    bool go = r > tolerance(t);
    while (go && count < MOST_STEPS) {{
        float there = t + z, R = map(o + there * d);
        bool bad = z > r + abs(R);
        t = bad && there < end ? t : there;
        z = bad ? r : 1.6 * R;
        r = bad ? r : R;
        go = t < end && r > tolerance(t);
        steps += 1.0;
        count += 1;
    }}
    unfinished = go ? 1.0 : 0.0;
    return t < end ? t : FAR;
}}
"""


@dataclass(frozen=True, slots=True)
class Saboteur:
    """A tracer that is wrong, and cases that must show it: one of each family that is there for such a thing."""

    fault: str
    template: str
    caught_by: tuple[str, ...]

    def record(self, name: str) -> Tracer:
        return Tracer(
            name=name,
            doc=self.fault,
            source="nobody",
            needs="",
            guarantee="",
            needs_map=True,
            needs_steps=False,
        )


SABOTEURS = {
    "coarse": Saboteur(
        "near enough is a thousandth, whatever the pixel and the scene",
        _sphere(eps="1e-3"),
        (
            "offset/moved by 0",
            "distance/seen from 10",
            "ratio/close by a ball 10 times larger",
            "tangent/sphere*1e-4",
            "edge/box from (1.0, 1.0, 1.0)",
            "axis/marched along +x",
            "shell/wire*0.01*",
            "ellipsoid/1 : 1 : 0.01*",
            "repeat/around an axis",
            "twist/bent bar, 90*",
            "detail/displaced of 0.4",
            "flat/a ball of fourth powers",
        ),
    ),
    "greedy": Saboteur(
        "steps by 1.9 radii, and never looks back",
        _sphere(step="1.9 * r"),
        ("shell/*0.0001*", "far/a thin sheet*", "ellipsoid/1 : 1 : 0.0001 from its face", "flush/three tenths"),
    ),
    "striding": Saboteur(
        "no step is shorter than a hundredth",
        _sphere(step="max(r, 0.01)"),
        ("shell/plate*", "far/a torus*", "detail/gyroid of 0.03", "tangent/sphere*1e-3"),
    ),
    "past the end": Saboteur(
        "a step that is not sound may end beyond the far plane: a miss", _PAST_THE_END, ("far/*",)
    ),
    "absolute": Saboteur(
        "near enough is a fixed length in the scene's unit",
        _sphere(eps="1e-4 / RADIUS"),
        ("scale/scaled by 0.0001", "scale/scaled by 0.01"),
    ),
    "far away": Saboteur(
        "points are reckoned from the eye, however far it is",
        _sphere(point="(o - travelled * d) + (t + travelled) * d"),
        ("distance/*1e+06",),
    ),
    "hasty": Saboteur(
        "gives up soon",
        _sphere().replace("MOST_STEPS", "24"),
        ("tangent/sphere*1e-5", "edge/box from (0.0, 0.0, 1.0)*", "twist/twisted bar, 1440*", "repeat/without end"),
    ),
    "inside out": Saboteur(
        "does not know that it starts inside",
        _sphere(radius="abs(map(p))"),
        ("start/within sphere*", "start/within box*"),
    ),
    "relative": Saboteur(
        "error is the radius over the distance travelled, 0/0 where the ray starts on a surface",
        _sphere(radius="map(p) / (t - start)", eps="tolerance(t)", step="r * (t - start)"),
        ("start/on sphere*", "start/on box*"),
    ),
    "not a number": Saboteur(
        "divides by how far the ray passes from the origin",
        _sphere(radius="map(p) * length(normalize(o - dot(o, d) * d))"),
        ("nan/cone's axis exactly*", "nan/sphere's centre exactly*"),
    ),
}
