"""`sdfc doctor`."""

from __future__ import annotations

import click

from sdfc.cli import options
from sdfc.cli.failure import EXIT_DEVICE


@click.command()
@options.json_option
@click.pass_context
def command(ctx: click.Context, as_json: bool) -> None:
    """Say which OpenGL there is, what works there, and what to install where something is missing.

    Exits with 3 where there is no usable OpenGL.
    """
    from sdfc.api.health import examine

    health = examine()
    rows = [*health.versions.items(), *health.device.items(), *health.folders.items()]
    width = max(len(name) for name, _ in rows)
    lines = [f"{name:<{width}}  {value}" for name, value in rows]
    lines += [
        f"{'works' if trial.works else 'FAILS':<{width}}  {trial.name}" + _remark(trial.remark)
        for trial in health.trials
    ]
    lines.append(health.verdict)
    details = {
        "healthy": health.is_usable,
        "versions": health.versions,
        "device": health.device,
        "folders": health.folders,
        "trials": [{"name": t.name, "works": t.works, "remark": t.remark} for t in health.trials],
        "verdict": health.verdict,
        "install": health.install,
    }
    options.say("\n".join(lines), details, as_json)
    if not health.is_usable:
        ctx.exit(EXIT_DEVICE)


def _remark(remark: str) -> str:
    return f" ({remark})" if remark else ""
