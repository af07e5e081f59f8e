"""What a tracer says about itself."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Tracer:
    """A row of the table. Its template, `templates/trace/NAME.glsl`, defines `trace(o, d, start, limit)`."""

    name: str
    doc: str
    source: str  # author, year
    needs: str
    guarantee: str
    needs_map: bool  # whether it reads `float map(vec3 p)`
    needs_steps: bool  # whether it reads the generated `events` and `march`

    @property
    def template(self) -> str:
        return f"trace/{self.name}.glsl"
