"""sdfc's own dataclasses do what the standard ones do, but for holding frozen ones frozen."""

import copy
import dataclasses
import pickle
from dataclasses import field
from typing import Any

import pytest

from sdfc import record


def described(dataclass: Any) -> tuple[type, type, type]:
    @dataclass(frozen=True, slots=True)
    class Point:
        """Somewhere."""

        x: float
        y: float = 0.0
        note: str = field(default="", compare=False, repr=False)

    @dataclass(frozen=True, slots=True, eq=False, kw_only=True)
    class Node:
        name: str

    @dataclass(slots=True)
    class Count:
        number: int

    return Point, Node, Count


OURS, STANDARD = described(record.dataclass), described(dataclasses.dataclass)


@pytest.mark.parametrize(("point", "node", "count"), [OURS, STANDARD])
def test_records(point: Any, node: Any, count: Any) -> None:
    assert point(1.0) == point(1.0, note="a") != point(2.0)
    assert point(1.0) != (1.0, 0.0) and count(1) == count(1) != count(2)
    assert len({point(1.0), point(1.0, note="a"), point(2.0)}) == 2
    assert node(name="a") != node(name="a") and len({node(name="a"), node(name="a")}) == 2
    with pytest.raises(TypeError):
        hash(count(1))
    assert repr(point(1.0)).endswith("Point(x=1.0, y=0.0)")
    assert repr(node(name="a")).endswith("Node(name='a')")
    assert dataclasses.replace(point(1.0), y=3.0) == point(1.0, 3.0)
    assert not hasattr(point(1.0), "__dict__")
    assert copy.deepcopy(point(1.0)) == point(1.0)
    match point(1.0, 2.0):
        case point(x, y):
            assert (x, y) == (1.0, 2.0)


def test_a_record_goes_between_processes() -> None:
    from sdfc.diagnostics import Diagnostic

    diagnostic = Diagnostic("wrong", None, "right")
    assert pickle.loads(pickle.dumps(diagnostic)) == diagnostic
