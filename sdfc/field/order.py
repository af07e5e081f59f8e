"""The order in which to compute a graph so that few values are alive at a time."""

from collections.abc import Callable, Iterable, Sequence

from sdfc.field.graph import Expr, topological


def evaluation_order(roots: Iterable[Expr], below: Callable[[Expr], Sequence[Expr]] | None = None) -> list[Expr]:
    """Every node below the roots, arguments before users: Sethi and Ullman 1970.

    The argument that needs the most live values is computed first, so a chain of 300 unions, nested to either side,
    keeps one distance and one leaf alive instead of 300 leaves. A heuristic where subexpressions are shared.
    """
    roots = list(roots)
    need: dict[Expr, int] = {}
    turned: dict[Expr, Sequence[Expr]] = {}  # the arguments of a node, where they are better taken in another order
    plain = topological(roots, below)
    for node in plain:
        args = node.args if below is None else below(node)
        if len(args) == 2:
            first, second = need[args[0]], need[args[1]]
            if first < second:
                turned[node] = (args[1], args[0])
                first, second = second, first
            need[node] = max(2, first, second + 1)
        elif len(args) < 2:
            need[node] = max(1, need[args[0]]) if args else 0
        else:
            demands = [need[a] for a in args]
            if demands != sorted(demands, reverse=True):
                turned[node] = sorted(args, key=lambda a: -need[a])
                demands.sort(reverse=True)
            need[node] = max(len(args), *[demand + held for held, demand in enumerate(demands)])
    if not turned:
        return plain
    return topological(roots, lambda node: turned.get(node) or (node.args if below is None else below(node)))
