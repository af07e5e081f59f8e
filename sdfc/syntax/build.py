"""The parser's callbacks: each reduction of the grammar makes its node at once, so that no tree is ever walked.

A method is named as its rule in grammar/scene.lark. It gets the rule's parts in order, tokens and nodes, with None
for an optional part that is not there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from sdfc.diagnostics import Source, Span
from sdfc.syntax import tree

if TYPE_CHECKING:
    from lark import Token

Parts = Sequence[Any]


def _nodes(parts: Parts) -> tuple[Any, ...]:
    """The parts that are nodes: without commas and brackets."""
    return tuple(part for part in parts if hasattr(part, "span"))


class Builder:
    """Makes the nodes of one text at a time."""

    def __init__(self) -> None:
        self.begin(Source("", ""), 0)

    def begin(self, source: Source, offset: int) -> None:
        """From now on, positions count from `offset` in `source`."""
        self.source = source
        self.offset = offset

    # --- places

    def _start(self, part: Any) -> int:
        return int(part.span.start) if hasattr(part, "span") else self.offset + int(part.start_pos)

    def _end(self, part: Any) -> int:
        return int(part.span.end) if hasattr(part, "span") else self.offset + int(part.end_pos)

    def _span(self, first: Any, last: Any = None) -> Span:
        return Span(self.source, self._start(first), self._end(first if last is None else last))

    def _identifier(self, token: Token) -> tree.Identifier:
        return tree.Identifier(self._span(token), str(token))

    def _whole(self, parts: Parts) -> Span:
        present = [part for part in parts if part is not None]
        return self._span(present[0], present[-1])

    def _text(self, token: Token) -> str:
        return str(token)[1:-1]

    # --- statements

    def start(self, parts: Parts) -> tuple[tree.Statement, ...]:
        return tuple(parts)

    def import_(self, parts: Parts) -> tree.Import:
        return tree.Import(self._whole(parts), self.text(parts[1:]))

    def param(self, parts: Parts) -> tree.ParamDeclaration:
        _, name, _, default, _, limits = parts
        return tree.ParamDeclaration(self._whole(parts), self._identifier(name), default, limits)

    def param_without_range(self, parts: Parts) -> tree.ParamDeclaration:
        _, name, _, default = parts
        return tree.ParamDeclaration(self._whole(parts), self._identifier(name), default, None)

    def properties(self, parts: Parts) -> tree.Properties:
        return tree.Properties(self._whole(parts), _nodes(parts))

    def property(self, parts: Parts) -> tree.Property:
        return tree.Property(self._whole(parts), self._identifier(parts[0]), parts[2])

    def material(self, parts: Parts) -> tree.MaterialDeclaration:
        _, name, properties = parts
        return tree.MaterialDeclaration(self._whole(parts), self._identifier(name), properties.entries)

    def camera(self, parts: Parts) -> tree.CameraDeclaration:
        return tree.CameraDeclaration(self._whole(parts), parts[1].entries)

    def light(self, parts: Parts) -> tree.LightDeclaration:
        _, name, properties = parts
        identifier = None if name is None else self._identifier(name)
        return tree.LightDeclaration(self._whole(parts), identifier, properties.entries)

    def sky(self, parts: Parts) -> tree.SkyDeclaration:
        return tree.SkyDeclaration(self._whole(parts), parts[1].entries)

    def scene(self, parts: Parts) -> tree.SceneDeclaration:
        return tree.SceneDeclaration(self._whole(parts), parts[1])

    # --- functions and fields

    def function(self, parts: Parts) -> tree.FunctionDeclaration:
        _, name, _, parameters, _, _, body, where = parts
        return tree.FunctionDeclaration(self._whole(parts), self._identifier(name), parameters, body, _bindings(where))

    def constant(self, parts: Parts) -> tree.FunctionDeclaration:
        _, name, _, body, where = parts
        return tree.FunctionDeclaration(self._whole(parts), self._identifier(name), None, body, _bindings(where))

    def def_parameters(self, parts: Parts) -> tuple[tree.DefParameter, ...]:
        return _nodes(parts)

    def def_parameter(self, parts: Parts) -> tree.DefParameter:
        name, _, default = parts
        return tree.DefParameter(self._whole(parts), self._identifier(name), default)

    def field(self, parts: Parts) -> tree.FieldDeclaration:
        _, name, _, parameters, _, (doc, place), _, formula, where, *claims = parts
        return tree.FieldDeclaration(
            self._whole(parts),
            self._identifier(name),
            parameters,
            doc,
            place,
            formula,
            _bindings(where),
            tuple(claims),
        )

    def field_head(self, parts: Parts) -> tuple[str, tree.Identifier | None]:
        doc = " ".join(self._text(part) for part in parts if part.type == "STRING")
        places = [self._identifier(part) for part in parts if part.type == "NAME"]
        return doc, places[0] if places else None

    def field_parameters(self, parts: Parts) -> tuple[tree.FieldParameter, ...]:
        return _nodes(parts)

    def field_parameter(self, parts: Parts) -> tree.FieldParameter:
        name, _, kind, *limits, _, default = parts
        identifier, kind_name = self._identifier(name), self._identifier(kind)
        return tree.FieldParameter(self._whole(parts), identifier, kind_name, tuple(limits), default)

    def limit(self, parts: Parts) -> tree.Limit:
        return tree.Limit(self._whole(parts), str(parts[0]), parts[1])

    def where(self, parts: Parts) -> tree.Where:
        return tree.Where(self._whole(parts), _nodes(parts))

    def binding(self, parts: Parts) -> tree.Binding:
        return tree.Binding(self._whole(parts), self._identifier(parts[0]), parts[2])

    def exactness(self, parts: Parts) -> tree.Claim:
        detail = str(parts[1]) if len(parts) > 1 and parts[1] is not None else ""
        return tree.Claim(self._whole(parts), str(parts[0]), detail)

    def word_claim(self, parts: Parts) -> tree.Claim:
        return tree.Claim(self._whole(parts), str(parts[0]))

    def dual_claim(self, parts: Parts) -> tree.Claim:
        return tree.Claim(self._whole(parts), "dual", str(parts[1]))

    def requirement(self, parts: Parts) -> tree.Claim:
        _, condition, message = parts
        return tree.Claim(self._whole(parts), "requires", self._text(message), condition)

    def ray_claim(self, parts: Parts) -> tree.Claim:
        dear, word, value, where = parts
        detail = "" if dear is None else str(dear)
        return tree.Claim(self._whole(parts), str(word), detail, value, _bindings(where))

    def formula_claim(self, parts: Parts) -> tree.Claim:
        word, value, where = parts
        return tree.Claim(self._whole(parts), str(word), "", value, _bindings(where))

    # --- expressions

    def loop(self, parts: Parts) -> tree.Loop:
        _, variable, _, iterable, _, body = parts
        return tree.Loop(self._whole(parts), self._identifier(variable), iterable, body)

    def conditional(self, parts: Parts) -> tree.Conditional:
        _, condition, _, then, _, otherwise = parts
        return tree.Conditional(self._whole(parts), condition, then, otherwise)

    def range(self, parts: Parts) -> tree.Range:
        return tree.Range(self._whole(parts), parts[0], parts[2])

    def operation(self, parts: Parts) -> tree.Operation:
        pairs = zip(parts[1::2], parts[2::2], strict=True)
        rest = tuple(tree.Operand(str(operator), self._span(operator), value) for operator, value in pairs)
        return tree.Operation(self._whole(parts), parts[0], rest)

    def unary(self, parts: Parts) -> tree.Unary:
        return tree.Unary(self._whole(parts), str(parts[0]), parts[1])

    def chain(self, parts: Parts) -> tree.Chain:
        return tree.Chain(self._whole(parts), parts[0], tuple(parts[1:]))

    def member(self, parts: Parts) -> tree.Member:
        return tree.Member(self._whole(parts), self._identifier(parts[1]))

    def method(self, parts: Parts) -> tree.Method:
        _, name, _, arguments, _ = parts
        return tree.Method(self._whole(parts), self._identifier(name), arguments)

    def index(self, parts: Parts) -> tree.Index:
        return tree.Index(self._whole(parts), parts[1])

    def number(self, parts: Parts) -> tree.Number:
        token = str(parts[0])
        digits = token.rstrip("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_%")
        return tree.Number(self._whole(parts), float(digits), token[len(digits) :])

    def color(self, parts: Parts) -> tree.Color:
        return tree.Color(self._whole(parts), str(parts[0])[1:])

    def text(self, parts: Parts) -> tree.Text:
        return tree.Text(self._whole(parts), self._text(parts[0]))

    def name(self, parts: Parts) -> tree.Name:
        return tree.Name(self._whole(parts), str(parts[0]))

    def parenthesised(self, parts: Parts) -> tree.Expression:
        inner: tree.Expression = parts[1]
        return inner

    def list(self, parts: Parts) -> tree.ListLiteral:
        return tree.ListLiteral(self._whole(parts), _nodes(parts))

    def call(self, parts: Parts) -> tree.Call:
        return tree.Call(self._whole(parts), self._identifier(parts[0]), parts[2], None)

    def call_with_block(self, parts: Parts) -> tree.Call:
        return tree.Call(self._whole(parts), self._identifier(parts[0]), parts[2], parts[4])

    def name_with_block(self, parts: Parts) -> tree.Call:
        return tree.Call(self._whole(parts), self._identifier(parts[0]), (), parts[1])

    def arguments(self, parts: Parts) -> tuple[tree.Argument, ...]:
        return _nodes(parts)

    def named_argument(self, parts: Parts) -> tree.Argument:
        return tree.Argument(self._whole(parts), self._identifier(parts[0]), parts[2])

    def positional_argument(self, parts: Parts) -> tree.Argument:
        return tree.Argument(parts[0].span, None, parts[0])

    def block(self, parts: Parts) -> tree.Block:
        return tree.Block(self._whole(parts), _nodes(parts))


def _bindings(where: tree.Where | None) -> tuple[tree.Binding, ...]:
    return where.bindings if where is not None else ()
