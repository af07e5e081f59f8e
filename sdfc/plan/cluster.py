"""Neighbours together: parts in clusters, so that one box can answer for several."""

from __future__ import annotations

from collections.abc import Sequence

from sdfc.plan.steps import Closed

CLUSTER = 16  # rows


def rows_at_once(count: int) -> int:
    """Rows a turn of a loop over `count`: so many that twenty rays and taps stay below llvmpipe's 65 535 turns."""
    return next((n for n in (1, 4) if turns(count, n) <= 2700), CLUSTER)


def turns(count: int, at_once: int) -> int:
    """How often the loops over the clusters of `count` parts and their rows may turn."""
    clusters = -(-count // CLUSTER)
    return clusters * (1 + CLUSTER // at_once)


def clustered(members: Sequence[Closed], size: int = CLUSTER) -> list[list[Closed]]:
    """Clusters of at most `size` neighbours, by halving along the longest axis; all but one on each branch are full."""
    groups: list[list[Closed]] = []
    stack = [list(members)]
    while stack:
        part = stack.pop()
        if len(part) <= size:
            groups.append(part)
            continue
        centres = [m.part.box.centre for m in part]
        spread = [max(c[axis] for c in centres) - min(c[axis] for c in centres) for axis in range(3)]
        axis = spread.index(max(spread))
        part.sort(key=lambda m: m.part.box.centre[axis])
        full = (len(part) + size - 1) // size
        half = size * (full // 2)
        stack += [part[half:], part[:half]]
    return groups
