"""The parser's callbacks: each reduction of the grammar makes its node at once, so that no tree is ever walked.

A method is named as its rule in grammar/scene.lark. It gets the rule's parts in order, tokens and nodes, with None
for an optional part that is not there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sdfc.diagnostics import Span
from sdfc.syntax import tree
from sdfc.syntax.machine import Token

Parts = Sequence[Any]
_UNIT = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_%"


def _nodes(parts: Parts) -> tuple[Any, ...]:
    """The parts that are nodes: without commas and brackets."""
    return tuple([part for part in parts if type(part) is not Token])


def _whole(parts: Parts) -> Span:
    """From the first part that is there to the last."""
    first = parts[0] or parts[1]
    last = parts[-1] or next(filter(None, reversed(parts)))
    return Span(first.span.source, first.span.start, last.span.end)


def _identifier(token: Token) -> tree.Identifier:
    return tree.Identifier(token.span, token.text)


def _unquoted(token: Token) -> str:
    return token.text[1:-1]


class Builder:
    """A method for each rule."""

    # --- statements

    def start(self, parts: Parts) -> tuple[tree.Statement, ...]:
        return tuple(parts)

    def import_(self, parts: Parts) -> tree.Import:
        return tree.Import(_whole(parts), self.text(parts[1:]))

    def param(self, parts: Parts) -> tree.ParamDeclaration:
        _, name, _, default, _, limits = parts
        return tree.ParamDeclaration(_whole(parts), _identifier(name), default, limits)

    def param_without_range(self, parts: Parts) -> tree.ParamDeclaration:
        _, name, _, default = parts
        return tree.ParamDeclaration(_whole(parts), _identifier(name), default, None)

    def properties(self, parts: Parts) -> tree.Properties:
        return tree.Properties(_whole(parts), _nodes(parts))

    def property(self, parts: Parts) -> tree.Property:
        return tree.Property(_whole(parts), _identifier(parts[0]), parts[2])

    def material(self, parts: Parts) -> tree.MaterialDeclaration:
        _, name, properties = parts
        return tree.MaterialDeclaration(_whole(parts), _identifier(name), properties.entries)

    def camera(self, parts: Parts) -> tree.CameraDeclaration:
        return tree.CameraDeclaration(_whole(parts), parts[1].entries)

    def light(self, parts: Parts) -> tree.LightDeclaration:
        _, name, properties = parts
        identifier = None if name is None else _identifier(name)
        return tree.LightDeclaration(_whole(parts), identifier, properties.entries)

    def sky(self, parts: Parts) -> tree.SkyDeclaration:
        return tree.SkyDeclaration(_whole(parts), parts[1].entries)

    def scene(self, parts: Parts) -> tree.SceneDeclaration:
        return tree.SceneDeclaration(_whole(parts), parts[1])

    # --- functions and fields

    def function(self, parts: Parts) -> tree.FunctionDeclaration:
        _, name, _, parameters, _, _, body, where = parts
        return tree.FunctionDeclaration(_whole(parts), _identifier(name), parameters, body, _bindings(where))

    def constant(self, parts: Parts) -> tree.FunctionDeclaration:
        _, name, _, body, where = parts
        return tree.FunctionDeclaration(_whole(parts), _identifier(name), None, body, _bindings(where))

    def def_parameters(self, parts: Parts) -> tuple[tree.DefParameter, ...]:
        return _nodes(parts)

    def def_parameter(self, parts: Parts) -> tree.DefParameter:
        name, _, default = parts
        return tree.DefParameter(_whole(parts), _identifier(name), default)

    def field(self, parts: Parts) -> tree.FieldDeclaration:
        _, name, _, parameters, _, (doc, place), _, formula, where, *claims = parts
        return tree.FieldDeclaration(
            _whole(parts),
            _identifier(name),
            parameters,
            doc,
            place,
            formula,
            _bindings(where),
            tuple(claims),
        )

    def field_head(self, parts: Parts) -> tuple[str, tree.Identifier | None]:
        doc = " ".join(_unquoted(part) for part in parts if part.type == "STRING")
        places = [_identifier(part) for part in parts if part.type == "NAME"]
        return doc, places[0] if places else None

    def field_parameters(self, parts: Parts) -> tuple[tree.FieldParameter, ...]:
        return _nodes(parts)

    def field_parameter(self, parts: Parts) -> tree.FieldParameter:
        name, _, kind, *limits, _, default = parts
        identifier, kind_name = _identifier(name), _identifier(kind)
        return tree.FieldParameter(_whole(parts), identifier, kind_name, tuple(limits), default)

    def limit(self, parts: Parts) -> tree.Limit:
        return tree.Limit(_whole(parts), parts[0].text, parts[1])

    def where(self, parts: Parts) -> tree.Where:
        return tree.Where(_whole(parts), _nodes(parts))

    def binding(self, parts: Parts) -> tree.Binding:
        return tree.Binding(_whole(parts), _identifier(parts[0]), parts[2])

    def exactness(self, parts: Parts) -> tree.Claim:
        detail = parts[1].text if len(parts) > 1 and parts[1] is not None else ""
        return tree.Claim(_whole(parts), parts[0].text, detail)

    def word_claim(self, parts: Parts) -> tree.Claim:
        return tree.Claim(_whole(parts), parts[0].text)

    def dual_claim(self, parts: Parts) -> tree.Claim:
        return tree.Claim(_whole(parts), "dual", parts[1].text)

    def requirement(self, parts: Parts) -> tree.Claim:
        _, condition, message = parts
        return tree.Claim(_whole(parts), "requires", _unquoted(message), condition)

    def ray_claim(self, parts: Parts) -> tree.Claim:
        dear, word, value, where = parts
        detail = "" if dear is None else dear.text
        return tree.Claim(_whole(parts), word.text, detail, value, _bindings(where))

    def formula_claim(self, parts: Parts) -> tree.Claim:
        word, value, where = parts
        return tree.Claim(_whole(parts), word.text, "", value, _bindings(where))

    # --- expressions

    def loop(self, parts: Parts) -> tree.Loop:
        _, variable, _, iterable, _, body = parts
        return tree.Loop(_whole(parts), _identifier(variable), iterable, body)

    def conditional(self, parts: Parts) -> tree.Conditional:
        _, condition, _, then, _, otherwise = parts
        return tree.Conditional(_whole(parts), condition, then, otherwise)

    def range(self, parts: Parts) -> tree.Range:
        return tree.Range(_whole(parts), parts[0], parts[2])

    def operation(self, parts: Parts) -> tree.Operation:
        pairs = zip(parts[1::2], parts[2::2], strict=True)
        rest = tuple(tree.Operand(operator.text, operator.span, value) for operator, value in pairs)
        return tree.Operation(_whole(parts), parts[0], rest)

    def unary(self, parts: Parts) -> tree.Unary:
        return tree.Unary(_whole(parts), parts[0].text, parts[1])

    def chain(self, parts: Parts) -> tree.Chain:
        return tree.Chain(_whole(parts), parts[0], tuple(parts[1:]))

    def member(self, parts: Parts) -> tree.Member:
        return tree.Member(_whole(parts), _identifier(parts[1]))

    def method(self, parts: Parts) -> tree.Method:
        _, name, _, arguments, _ = parts
        return tree.Method(_whole(parts), _identifier(name), arguments)

    def index(self, parts: Parts) -> tree.Index:
        return tree.Index(_whole(parts), parts[1])

    def number(self, parts: Parts) -> tree.Number:
        (token,) = parts
        digits = token.text.rstrip(_UNIT)
        return tree.Number(token.span, float(digits), token.text[len(digits) :])

    def color(self, parts: Parts) -> tree.Color:
        return tree.Color(parts[0].span, parts[0].text[1:])

    def text(self, parts: Parts) -> tree.Text:
        return tree.Text(parts[0].span, _unquoted(parts[0]))

    def name(self, parts: Parts) -> tree.Name:
        return tree.Name(parts[0].span, parts[0].text)

    def parenthesised(self, parts: Parts) -> tree.Expression:
        inner: tree.Expression = parts[1]
        return inner

    def list(self, parts: Parts) -> tree.ListLiteral:
        return tree.ListLiteral(_whole(parts), _nodes(parts))

    def call(self, parts: Parts) -> tree.Call:
        return tree.Call(_whole(parts), _identifier(parts[0]), parts[2], None)

    def call_with_block(self, parts: Parts) -> tree.Call:
        return tree.Call(_whole(parts), _identifier(parts[0]), parts[2], parts[4])

    def name_with_block(self, parts: Parts) -> tree.Call:
        return tree.Call(_whole(parts), _identifier(parts[0]), (), parts[1])

    def arguments(self, parts: Parts) -> tuple[tree.Argument, ...]:
        return _nodes(parts)

    def named_argument(self, parts: Parts) -> tree.Argument:
        return tree.Argument(_whole(parts), _identifier(parts[0]), parts[2])

    def positional_argument(self, parts: Parts) -> tree.Argument:
        return tree.Argument(parts[0].span, None, parts[0])

    def block(self, parts: Parts) -> tree.Block:
        return tree.Block(_whole(parts), _nodes(parts))


def _bindings(where: tree.Where | None) -> tuple[tree.Binding, ...]:
    return where.bindings if where is not None else ()
