"""Over-relaxation with a fixed factor."""

from sdfc.tracers.record import FORCE, REDUCE, STALLS, Parameter, Tracer

ENTRY = Tracer(
    name="relaxed",
    doc="Looks omega radii ahead, and takes one plain step where the two balls do not meet.",
    source="Keinert et al. 2014, sections 3.1 and 3.2",
    needs="a Lipschitz constant for every part",
    guarantee="nothing missed; hits are early by up to the tolerance; what is given up is said to be",
    needs_map=True,
    needs_steps=False,
    parameters=(
        Parameter("omega", 1.2, 1.0, 1.99, "radii that a step looks ahead"),
        FORCE,
        REDUCE,
    ),
    pace=0.9,
    weight=1.1,
    weak=STALLS,
)
