"""Sphere tracing that walks on where its steps are short, for comparison."""

from sdfc.tracers.record import STALLS, Parameter, Tracer

THIN = dict.fromkeys(
    ("distance", "start", "nan", "ellipsoid", "repeat", "twist", "detail", "shell"),
    "what is nowhere deeper than half the least step is lost",
)

ENTRY = Tracer(
    name="liktor",
    doc="Sphere tracing with a least step, to the first look at the inside; then a fixed number of refinements.",
    source="Liktor 2008, section 5.4 and listing 2; Anderson & Björck 1973",
    needs="a Lipschitz constant for every part, and solids that are deeper than half the least step",
    guarantee="what is lost along a ray is nowhere deeper than half the least step",
    needs_map=True,
    needs_steps=False,
    parameters=(
        Parameter("min_step", 1.0, 1e-3, 1e3, "the least step, in half pixels where the ray is"),
        Parameter("refinements", 4.0, 0.0, 64.0, "of the bracket, after the first look at the inside", True),
        Parameter("plain", 0.0, 0.0, 1.0, "1: regula falsi, as published", True),
    ),
    pace=0.9,
    weight=1.4,
    weak=STALLS | THIN,
)
