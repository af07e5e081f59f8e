"""`sdfc list`."""

from __future__ import annotations

import click

from sdfc.cli import options

_KINDS = ("primitives", "operations", "tracers", "targets")


@click.command("list")
@click.argument("kinds", nargs=-1, type=click.Choice(_KINDS), metavar="[primitives|operations|tracers|targets]...")
@options.json_option
def command(kinds: tuple[str, ...], as_json: bool) -> None:
    """List primitives, operations, tracers and targets: all of them, or the kinds that are named."""
    from sdfc.api.inspect import listing

    tables = {kind: listing(kind) for kind in kinds or _KINDS}
    details = {kind: [{"use": use, "description": doc} for use, doc in rows] for kind, rows in tables.items()}
    options.say("\n\n".join(_table(kind, rows) for kind, rows in tables.items()), details, as_json)


def _table(kind: str, rows: list[tuple[str, str]]) -> str:
    lines = [f"{kind} ({len(rows)})"]
    for use, doc in rows:
        lines += [f"  {use}", *([f"      {doc}"] if doc else [])]
    return "\n".join(lines)
