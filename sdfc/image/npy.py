"""NumPy's own file format."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray


def encode(values: NDArray[Any]) -> bytes:
    """A `.npy` file: float32 for floats, the array's own type for whole numbers."""
    import numpy as np

    stored = values.astype(np.float32) if values.dtype.kind == "f" else values
    buffer = io.BytesIO()
    np.save(buffer, np.ascontiguousarray(stored), allow_pickle=False)
    return buffer.getvalue()
