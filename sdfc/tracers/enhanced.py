"""Steps for a field that is linear along the ray."""

from sdfc.tracers.record import FORCE, REDUCE, STALLS, Parameter, Tracer

ENTRY = Tracer(
    name="enhanced",
    doc="Looks to where the next ball would touch, were the field linear; one plain step where it does not.",
    source="Bálint & Valasek 2018",
    needs="a Lipschitz constant for every part",
    guarantee="nothing missed; hits are early by up to the tolerance; what is given up is said to be",
    needs_map=True,
    needs_steps=False,
    parameters=(
        Parameter("omega", 0.95, 0.0, 1.0, "share of the way beyond the ball that is looked ahead"),
        FORCE,
        REDUCE,
    ),
    pace=0.7,
    weight=1.25,
    weak=STALLS,
)
