"""The order in which to compute a graph so that few values are alive at a time."""

from collections.abc import Callable, Iterable, Sequence

from sdfc.field.graph import Expr, arguments, topological


def evaluation_order(roots: Iterable[Expr], below: Callable[[Expr], Sequence[Expr]] = arguments) -> list[Expr]:
    """Every node below the roots, arguments before users: Sethi and Ullman 1970.

    The argument that needs the most live values is computed first, so a chain of 300 unions, nested to either side,
    keeps one distance and one leaf alive instead of 300 leaves. A heuristic where subexpressions are shared.
    """
    roots = list(roots)
    need: dict[int, int] = {}
    for node in topological(roots, below):
        demands = sorted((need[a.id] for a in below(node)), reverse=True)
        need[node.id] = max((demand + held for held, demand in enumerate(demands)), default=0) or len(demands)
    return list(topological(roots, lambda node: sorted(below(node), key=lambda a: -need[a.id])))
