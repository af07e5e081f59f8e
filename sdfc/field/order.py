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
    turned: dict[int, Sequence[Expr]] = {}  # the arguments of a node, where they are better taken in another order
    plain = list(topological(roots, below))
    for node in plain:
        args = below(node)
        if len(args) < 2:
            need[node.id] = max(1, need[args[0].id]) if args else 0
            continue
        demands = [need[a.id] for a in args]
        if demands != sorted(demands, reverse=True):
            turned[node.id] = args = sorted(args, key=lambda a: -need[a.id])
            demands.sort(reverse=True)
        need[node.id] = max(len(args), *(demand + held for held, demand in enumerate(demands)))
    return list(topological(roots, lambda node: turned.get(node.id) or below(node))) if turned else plain
