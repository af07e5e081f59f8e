"""Steps by how fast the field can fall over the piece of the ray ahead."""

from sdfc.tracers.record import Parameter, Tracer

ENTRY = Tracer(
    name="segment",
    doc="Steps by a bound of the field's slope over the piece of the ray ahead; never shorter than sphere tracing.",
    source="Galin et al. 2020; Aydinlilar & Zanni 2023",
    needs="a Lipschitz constant for every part, and bounds of its slope along a ray",
    guarantee="nothing missed; hits are early by up to the tolerance; what is given up is said to be",
    needs_map=True,
    needs_steps=False,
    needs_span=True,
    parameters=(
        Parameter("growth", 2.0, 1.0, 8.0, "the piece looked at, of the last step"),
        Parameter("symmetric", 0.0, 0.0, 1.0, "1: the slope's largest size, as Galin; 0: how fast it falls", True),
    ),
    pace=0.2,
    weight=4.5,
)
