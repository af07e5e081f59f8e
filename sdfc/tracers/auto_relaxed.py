"""Over-relaxation whose factor follows the field."""

from sdfc.tracers.record import FORCE, REDUCE, STALLS, Parameter, Tracer

ENTRY = Tracer(
    name="auto_relaxed",
    doc="Looks to where the next ball would touch, by a running mean of the field's slope; one plain step where not.",
    source="Bán & Valasek 2023",
    needs="a Lipschitz constant for every part",
    guarantee="nothing missed; hits are early by up to the tolerance; what is given up is said to be",
    needs_map=True,
    needs_steps=False,
    parameters=(
        Parameter("beta", 0.3, 0.0, 1.0, "weight of the newest slope in the mean"),
        FORCE,
        REDUCE,
    ),
    pace=0.68,
    weight=1.25,
    weak=STALLS,
)
