"""The command line: one click verb a file."""


def main() -> None:
    """The `sdfc` command."""
    import os
    import signal
    import sys

    try:
        from sdfc.cli.verbs import EXIT_TERMINATED, command

        if sys.stdout is None:  # closed by whoever called: what is said goes nowhere
            sys.stdout = os.fdopen(os.open(os.devnull, os.O_WRONLY), "w")
        # As an exception, so that what is half done is cleared away as it is on Ctrl-C.
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(EXIT_TERMINATED))
        command.main(prog_name="sdfc")
    except KeyboardInterrupt:  # before or after the verb itself, which has its own way to say this
        sys.exit(130)
