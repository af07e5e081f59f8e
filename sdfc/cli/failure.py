"""How failures are told, and what each exits with."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable
from typing import Any

import click

from sdfc.diagnostics import DeviceError, Diagnostic, SceneError, show_all

EXIT_SCENE = 1
EXIT_USAGE = 2
EXIT_DEVICE = 3
EXIT_BUG = 70
EXIT_INTERRUPTED = 130
EXIT_TERMINATED = 143

_REQUEST_ERRORS = frozenset({"RequestError", "OutputError"})


def report(error: BaseException, as_json: bool) -> int:
    """Say what went wrong, in words on stderr or as JSON on stdout, and return the exit code."""
    words, code, details = account(error)
    if as_json:
        click.echo(json.dumps({"ok": False, "exit": code, **details}, indent=2))
    if not as_json or (code == EXIT_BUG and _is_debugging()):
        click.echo(words, err=True)
    return code


def account(error: BaseException) -> tuple[str, int, dict[str, Any]]:
    """What went wrong in words, the exit code, and what JSON has of it."""
    match error:
        case SceneError():
            details: dict[str, Any] = {"diagnostics": [described(d) for d in error.diagnostics]}
            return show_all(error.diagnostics), EXIT_SCENE, details
        case DeviceError():
            return f"error: {error}", EXIT_DEVICE, {"message": str(error)}
        case KeyboardInterrupt():
            return "\ninterrupted", EXIT_INTERRUPTED, {"message": "interrupted"}
        case _ if type(error).__name__ in _REQUEST_ERRORS:  # by name: their modules may not even be loaded
            return f"error: {error}", EXIT_USAGE, {"message": str(error)}
        case _:
            stage = _stage(error)
            details = {"message": f"{type(error).__name__}: {error}", "stage": stage}
            return _bug(error, stage), EXIT_BUG, details


def described(diagnostic: Diagnostic) -> dict[str, Any]:
    """A diagnostic for JSON: the words, and the place from 1 where it has one."""
    place: dict[str, Any] = {}
    if diagnostic.span is not None:
        source = diagnostic.span.source
        line, column = source.position(diagnostic.span.start)
        end_line, end_column = source.position(diagnostic.span.end)
        place = {"file": source.name, "line": line, "column": column, "end_line": end_line, "end_column": end_column}
    return {"severity": diagnostic.severity, "message": diagnostic.message, "hint": diagnostic.hint, **place}


def warn(warnings: Iterable[Diagnostic]) -> None:
    """Warnings, on stderr."""
    shown = tuple(warnings)
    if shown:
        click.echo(show_all(shown), err=True)


def suggestion(name: str, known: Iterable[str]) -> str:
    """` (did you mean 'x'?)` where something is close."""
    from difflib import get_close_matches

    close = get_close_matches(name, list(known), n=1)
    return f" (did you mean '{close[0]}'?)" if close else ""


def close_quietly() -> None:
    """After a broken pipe: let Python's own flush at exit go nowhere, and say nothing."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, sys.stdout.fileno())
    os.close(null)


def _is_debugging() -> bool:
    return os.environ.get("SDFC_DEBUG") == "1"


def _stage(error: BaseException) -> str:
    """The part of sdfc that was at work: the innermost one on the stack."""
    from traceback import walk_tb

    for frame, _ in reversed(list(walk_tb(error.__traceback__))):
        module = frame.f_globals.get("__name__", "")
        if module.startswith("sdfc."):
            return str(module.split(".")[1])
    return "cli"


def _bug(error: BaseException, stage: str) -> str:
    message = (
        str(error) if type(error).__name__.startswith(("Internal", "Shader")) else f"{type(error).__name__}: {error}"
    )
    if _is_debugging():
        from traceback import format_exception

        shown = "".join(format_exception(error))
        return f"{shown}error: this is a bug in sdfc, in its {stage} stage"
    advice = "please report it with the scene; SDFC_DEBUG=1 shows the traceback"
    return f"error: this is a bug in sdfc, in its {stage} stage: {message}\n  {advice}"
