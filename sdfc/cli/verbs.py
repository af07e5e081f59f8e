"""The table of verbs, each imported when it is called, and what each way to fail exits with."""

from __future__ import annotations

import errno
import importlib
import sys
from typing import Any

import click

from sdfc import __version__
from sdfc.cli.failure import EXIT_TERMINATED, EXIT_USAGE, close_quietly, report

__all__ = ["EXIT_TERMINATED", "command"]

_VERBS: dict[str, tuple[str, str]] = {
    "render": ("sdfc.cli.render", "Render a scene to a picture."),
    "watch": ("sdfc.cli.watch", "Render a scene again whenever it is saved."),
    "check": ("sdfc.cli.check", "Say what is wrong with a scene, or show what the compiler makes of it."),
    "explain": ("sdfc.cli.explain", "Say what is proved of a scene, and how it will be traced."),
    "emit-glsl": ("sdfc.cli.emit_glsl", "Write a scene as one complete GLSL shader."),
    "list": ("sdfc.cli.listing", "List primitives, operations and tracers."),
    "bench": ("sdfc.cli.bench", "Measure time against error, of every tracer, judged by certified truth."),
    "stress": ("sdfc.cli.stress", "Trace what is numerically hard, and judge it by certified truth."),
    "doctor": ("sdfc.cli.doctor", "Say which OpenGL there is, what works there, what is missing."),
    "completion": ("sdfc.cli.completion", "Print the script that completes sdfc's words in a shell."),
}
"""Each verb's module, whose `command` it is, and its line in the help: known here so that the help imports no verb."""


_STREAM_ERRORS = frozenset({errno.ENOSPC, errno.EIO, errno.EBADF, errno.EDQUOT, errno.EFBIG})
"""What writing to a full or broken standard output raises, without a file's name."""


class _Verbs(click.Group):
    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in _VERBS:
            return None
        verb: click.Command = importlib.import_module(_VERBS[cmd_name][0]).command
        return verb

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Verbs"):
            formatter.write_dl([(name, line) for name, (_, line) in _VERBS.items()])

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and args[0] not in _VERBS and not args[0].startswith("-"):
            from sdfc.cli.failure import suggestion

            ctx.fail(f"there is no verb '{args[0]}'{suggestion(args[0], _VERBS)}")
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        try:
            result = super().invoke(ctx)
            sys.stdout.flush()
        except (click.ClickException, click.exceptions.Exit):
            raise
        except BrokenPipeError:  # the reader has had enough
            close_quietly()
            ctx.exit(0)
        except OSError as error:
            if error.filename is not None or error.errno not in _STREAM_ERRORS:
                ctx.exit(report(error, as_json=bool(ctx.meta.get("sdfc.json"))))
            click.echo(f"error: cannot write to standard output: {error.strerror}", err=True)
            close_quietly()
            ctx.exit(EXIT_USAGE)
        except (Exception, KeyboardInterrupt) as error:
            ctx.exit(report(error, as_json=bool(ctx.meta.get("sdfc.json"))))
        return result


@click.group(cls=_Verbs, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, message="sdfc %(version)s")
def command() -> None:
    """Compile CSG scenes to GLSL, and render them.

    A scene is a .sdf file, a .csg file that OpenSCAD wrote, or - for standard input.
    """
