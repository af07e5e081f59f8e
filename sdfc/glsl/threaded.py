"""Shaders without variables of their own: globals that change become members of a `State` that functions hand on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sdfc.diagnostics import InternalError
from sdfc.glsl.source import Item, Kind

_TYPES = frozenset({"float", "int", "bool", "vec2", "vec3", "vec4", "ivec2", "ivec3"})


def threaded(items: Sequence[Item]) -> list[Item]:
    """The items with `State` and `start_state()` in place of variables; what needs a state takes it first."""
    variables = [item for item in items if item.kind is Kind.VARIABLE]
    if not variables:
        return list(items)
    members = {name for item in variables for name in item.names}
    users = _users(items, members)
    kept = [item for item in items if item.kind is not Kind.VARIABLE]
    # constants and structs come first, so that the state may be made of any of them
    head = [item for item in kept if item.kind is not Kind.FUNCTION]
    functions = [item for item in kept if item.kind is Kind.FUNCTION]
    return [*head, *_state(variables), *(_handed(f, members, users) for f in functions)]


def _users(items: Sequence[Item], members: set[str]) -> set[str]:
    """The functions that read or write a variable, or call one that does. Overloads are taken together."""
    functions = [item for item in items if item.kind is Kind.FUNCTION]
    users: set[str] = set()
    while True:
        found = {f.names[0] for f in functions if f.words & (members | users)}
        if found <= users:
            return users
        users |= found


def _state(variables: Sequence[Item]) -> list[Item]:
    declared, initial = [], []
    for item in variables:
        if len(item.names) != 1:
            raise InternalError(f"globals are declared one by one, not so: {item.text}")
        declared.append(f"    {item.type} {item.names[0]};" + (f"  // {item.note}" if item.note else ""))
        value = item.text.rpartition("=")[2].strip(" ;") if "=" in item.text else _nothing(item.type)
        initial.append(f"    state.{item.names[0]} = {value};")
    lines = ["struct State {", *declared, "};"]
    made = ["State start_state() {", "    State state;", *initial, "    return state;", "}"]
    return [
        Item(Kind.STRUCT, ("State",), "State", "\n".join(lines)),
        Item(Kind.FUNCTION, ("start_state",), "State", "\n".join(made)),
    ]


def _nothing(type_: str) -> str:
    return {"float": "0.0", "int": "0", "bool": "false"}.get(type_, f"{type_}(0.0)")


def _handed(function: Item, members: set[str], users: set[str]) -> Item:
    if function.names[0] not in users:
        return function
    tokens = list(function.tokens)
    code = [i for i, t in enumerate(tokens) if not t.isspace() and not t.startswith("//")]
    heading = True
    for place, i in enumerate(code):
        token, previous = tokens[i], tokens[code[place - 1]] if place else ""
        following = [tokens[j] for j in code[place + 1 : place + 3]]
        if token in members and previous != ".":
            if previous in _TYPES:
                raise InternalError(f"{function.names[0]} has a variable that hides the global {token}")
            tokens[i] = f"state.{token}"
        elif token in users and following[:1] == ["("]:
            opening = code[place + 1]
            given = "inout State state" if heading else "state"
            tokens[opening] = f"({given}" if following[1] == ")" else f"({given}, "
            heading = False
    return replace(function, text="".join(tokens))
