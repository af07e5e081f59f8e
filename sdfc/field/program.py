"""Expressions as plain numbers: what a graph would fold, without a graph."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from sdfc.field.folding import fold
from sdfc.field.graph import Expr, Op, Value, topological

Numbers: TypeAlias = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class _Step:
    op: Op
    args: tuple[int, ...]  # registers
    size: int
    value: Value


class Program:
    """Some expressions of some leaves. It keeps no node of their graph."""

    def __init__(self, leaves: Sequence[Expr], roots: Sequence[Expr]) -> None:
        order = topological(roots)
        constants = [node for node in order if node.is_constant]
        computed = [node for node in order if node.args]
        register = {node: i for i, node in enumerate((*leaves, *constants, *computed))}
        assert len(register) >= len(order), "a leaf that is not given"
        self._constants = tuple([node.numbers for node in constants])
        self._steps = tuple([_Step(n.op, tuple([register[a] for a in n.args]), n.type.size, n.value) for n in computed])
        self._roots = tuple([register[root] for root in roots])

    def __call__(self, leaves: Sequence[Numbers]) -> list[Numbers]:
        """The roots' components, where the leaves have these."""
        registers = [*leaves, *self._constants]
        for step in self._steps:
            registers.append(fold(step.op, [registers[a] for a in step.args], step.size, step.value))
        return [registers[root] for root in self._roots]
