"""The baseline."""

from sdfc.tracers.record import Tracer

ENTRY = Tracer(
    name="sphere",
    doc="Sphere tracing: steps by the distance bound.",
    source="Hart 1996",
    needs="a Lipschitz constant for every part",
    guarantee="nothing missed; hits are early by up to the tolerance",
    needs_map=True,
    needs_steps=False,
)
