"""The baseline."""

from sdfc.tracers.record import STALLS, Tracer

ENTRY = Tracer(
    name="sphere",
    doc="Sphere tracing: steps by the distance bound.",
    source="Hart 1996",
    needs="a Lipschitz constant for every part",
    guarantee="nothing missed; hits are early by up to the tolerance; what is given up is said to be",
    needs_map=True,
    needs_steps=False,
    weak=STALLS,
)
