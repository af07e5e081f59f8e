"""Each part by the best rule that it can prove."""

from sdfc.tracers.record import Tracer

ENTRY = Tracer(
    name="proven",
    doc="Events of closed-form ray intervals, tangents of convex functions, Lipschitz balls for the rest.",
    source="sdfc; generalises Roth 1982, Hart 1996 and Aydinlilar & Zanni 2023",
    needs="nothing more than every part has",
    guarantee="nothing missed, nothing invented outside contested pixels; hard CSG of closed-form parts to a few ulps",
    needs_map=False,
    needs_steps=True,
)
