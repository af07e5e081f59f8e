"""Colours as they are written."""

from __future__ import annotations

from sdfc.diagnostics import scene_error
from sdfc.syntax import tree


def linear(component: float) -> float:
    """An sRGB component (0 to 1) as light (IEC 61966-2-1, 1999)."""
    return float(component / 12.92 if component <= 0.04045 else ((component + 0.055) / 1.055) ** 2.4)


def hexadecimal(node: tree.Color) -> tuple[float, float, float]:
    """`#rgb` or `#rrggbb`, sRGB, as linear RGB."""
    digits = node.digits
    if len(digits) not in (3, 6) or not set(digits) <= set("0123456789abcdefABCDEF"):
        raise scene_error(f"'#{digits}' is not a colour", node.span, "a colour is #rrggbb or #rgb, in hexadecimal")
    pairs = [c * 2 for c in digits] if len(digits) == 3 else [digits[i : i + 2] for i in (0, 2, 4)]
    red, green, blue = (linear(int(pair, 16) / 255) for pair in pairs)
    return red, green, blue
