"""Makes the tables `models/*.points` with OpenSCAD itself. Not a test: run it by hand where `openscad` is installed.

For each `models/*.csg` OpenSCAD makes a mesh, its true curves cut into many facets. Points around its surface and in
its box are kept with whether they are inside (by the winding number: Jacobson, Kavan and Sorkine-Hornung, 2013), unless
they are so near to the surface that the facets decide.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

MODELS = Path(__file__).parent / "models"
FACETS = 90
POINTS = 120  # inside, and as many outside
NEAR = 2e-3  # of the size: closer points are left out
Array = np.ndarray[Any, Any]


def mesh(csg: str) -> Array:
    """Triangles (t, 3, 3) of OpenSCAD's mesh."""
    fine = re.sub(r"\$fn = 0\b", f"$fn = {FACETS}", csg)
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder, "model.csg"), Path(folder, "model.off")
        source.write_text(fine)
        environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
        subprocess.run(
            ["openscad", "-o", target, source], check=True, capture_output=True, env=environment, timeout=900
        )
        words = target.read_text().split()
    count, faces = int(words[1]), int(words[2])
    corners = np.array(words[4 : 4 + 3 * count], dtype=float).reshape(count, 3)
    triangles, at = [], 4 + 3 * count
    for _ in range(faces):
        size = int(words[at])
        face = [int(w) for w in words[at + 1 : at + 1 + size]]
        triangles += [(face[0], face[i], face[i + 1]) for i in range(1, size - 1)]
        at += 1 + size
        while at < len(words) and "." in words[at]:  # a face may have a colour
            at += 1
    return corners[np.array(triangles)]


def winding(points: Array, triangles: Array) -> Array:
    """How often the mesh goes around each point: the sum of solid angles (Van Oosterom and Strackee, 1983)."""
    total = np.zeros(len(points))
    for part in np.array_split(triangles, max(1, len(triangles) // 200)):
        a, b, c = (part[None, :, i] - points[:, None] for i in range(3))
        la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
        over = np.einsum("pti,pti->pt", a, np.cross(b, c))
        under = la * lb * lc + np.sum(a * b, -1) * lc + np.sum(b * c, -1) * la + np.sum(c * a, -1) * lb
        total += 2.0 * np.arctan2(over, under).sum(axis=1)
    return total / (4.0 * np.pi)


def distance(points: Array, triangles: Array) -> Array:
    """To the nearest point of the mesh: inside a triangle's prism its plane, else its edges."""
    nearest = np.full(len(points), np.inf)
    for part in np.array_split(triangles, max(1, len(triangles) // 200)):
        normal = np.cross(part[:, 1] - part[:, 0], part[:, 2] - part[:, 0])
        length = np.linalg.norm(normal, axis=1)
        normal /= np.maximum(length, 1e-300)[:, None]
        height = np.einsum("pti,ti->pt", points[:, None] - part[None, :, 0], normal)
        within = np.broadcast_to(length > 0.0, height.shape)
        edges = np.full(height.shape, np.inf)
        for i in range(3):
            start, along = part[:, i], part[:, (i + 1) % 3] - part[:, i]
            to = points[:, None] - start[None]
            within = within & (np.einsum("pti,ti->pt", to, np.cross(normal, along)) >= 0.0)
            t = np.clip(np.einsum("pti,ti->pt", to, along) / np.maximum((along**2).sum(-1), 1e-300), 0.0, 1.0)
            edges = np.minimum(edges, np.linalg.norm(to - t[..., None] * along[None], axis=-1))
        nearest = np.minimum(nearest, np.where(within, np.abs(height), edges).min(axis=1))
    return nearest


def table(triangles: Array, seed: int) -> Array:
    """Points (n, 3) and whether each is inside (n), as (n, 4)."""
    random = np.random.default_rng(seed)
    lo, hi = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    size = float((hi - lo).max())
    area = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
    chosen = triangles[random.choice(len(triangles), 6 * POINTS, p=area / area.sum())]
    weights = random.dirichlet((1.0, 1.0, 1.0), len(chosen))
    spread = size * 10.0 ** random.uniform(-2.5, -1.5, (len(chosen), 1))
    near = np.einsum("pk,pki->pi", weights, chosen) + random.normal(size=(len(chosen), 3)) * spread
    around = random.uniform(lo - 0.05 * size, hi + 0.05 * size, (POINTS, 3))
    points = np.round(np.concatenate([near, around]), 4)
    points = points[distance(points, triangles) > NEAR * size]
    inside = np.abs(winding(points, triangles)) > 0.5
    kept = [random.permutation(np.nonzero(side)[0])[:POINTS] for side in (inside, ~inside)]
    return np.column_stack([points, inside])[np.concatenate(kept)]


def main() -> None:
    names = sys.argv[1:] or sorted(path.stem for path in MODELS.glob("*.csg"))
    for name in names:
        text = (MODELS / f"{name}.csg").read_text()
        if name.startswith("flat"):  # as OpenSCAD's preview shows what is in the plane
            text = f"linear_extrude(height = 1, center = true) {{ {text} }}"
        rows = table(mesh(text), seed=len(name))
        lines = [f"{x:.4f} {y:.4f} {z:.4f} {int(inside)}" for x, y, z, inside in rows]
        (MODELS / f"{name}.points").write_text("\n".join(lines) + "\n")
        print(name, len(rows), int(rows[:, 3].sum()))


if __name__ == "__main__":
    main()
