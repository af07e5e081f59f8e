"""`sdfc completion`."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class


@click.command()
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
@click.pass_context
def command(ctx: click.Context, shell: str) -> None:
    """Print the script that completes sdfc's words in SHELL.

    \b
    bash: eval "$(sdfc completion bash)" in ~/.bashrc
    zsh:  eval "$(sdfc completion zsh)" in ~/.zshrc
    fish: sdfc completion fish > ~/.config/fish/completions/sdfc.fish
    """
    maker = get_completion_class(shell)
    if maker is None:
        raise click.UsageError(f"no completion for {shell}")
    click.echo(maker(ctx.find_root().command, {}, "sdfc", "_SDFC_COMPLETE").source())
