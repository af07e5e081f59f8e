"""Somebody who edits a scene's file, and has each edit drawn."""

from __future__ import annotations

from pathlib import Path

from sdfc.live.session import Session, Update
from sdfc.live.snapshot import take

SIZE = (64, 36)

BALLS = """\
param size = 0.5 in 0.1..1.0
material red { color: #ff2010, roughness: 0.4 }
field bump(height: number) = length(p) - height - 0.05 * sin(7 * p.x)
def many = 3
camera { eye: [0, 1, 4], target: [0, 0, 0], fov: 40deg }
light sun { direction: [-1, -2, -1], intensity: 3.5 }
scene {
    union(for i in 0..many: sphere(radius: 0.25).translate([0.7 * i - 0.7, 0, 0])).material(red)
    box(size: [size, 0.3, 0.3]).round(0.02).translate([0, 0.8, 0]).rotate(z: 10deg)
    bump(0.3).translate([0, -0.8, 0])
}
"""

OTHER = BALLS.replace("many = 3", "many = 2")


class Author:
    """Edits a scene's file, and has each edit drawn."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir(exist_ok=True)
        self.scene = folder / "s.sdf"
        self.picture = folder / "o.npy"
        self.session = Session(self.picture, SIZE, "auto", "gl", print)

    def save(self, text: str) -> Update:
        self.scene.write_text(text)
        return self.session.update(take(self.scene))
