"""The types and the operations of the field graph."""

from enum import Enum


class Type(Enum):
    """The type of an expression; the value is its number of components (0 for a boolean)."""

    BOOL = 0
    FLOAT = 1
    VEC2 = 2
    VEC3 = 3
    VEC4 = 4

    size: int

    def __init__(self, components: int) -> None:
        self.size = max(1, components)

    __hash__ = object.__hash__  # members are single; Enum's own is slow, and nodes are looked up by it


class Op(Enum):
    """Every operation of the field graph. Each interpretation has a row for every one of them (tested)."""

    __hash__ = object.__hash__

    # leaves; Expr.value says which
    CONST = "const"  # value: tuple of floats, or (True,)/(False,) for a boolean
    INPUT = "input"  # value: a name: p (the point), o and d (a ray), a function's parameter, ...
    PARAM = "param"  # value: the name of a live `param` of the scene (a uniform)
    # vectors
    VECTOR = "vector"  # args: 2 to 4 scalars
    SWIZZLE = "swizzle"  # value: tuple of 1 to 4 indices
    DOT = "dot"
    LENGTH = "length"
    # component by component
    NEG = "neg"
    ABS = "abs"
    SIGN = "sign"
    FLOOR = "floor"
    ROUND = "round"
    SQRT = "sqrt"
    SIN = "sin"
    COS = "cos"
    TAN = "tan"
    ASIN = "asin"
    ACOS = "acos"
    ATAN = "atan"
    EXP = "exp"
    LOG = "log"
    ADD = "add"
    SUB = "sub"
    MUL = "mul"
    DIV = "div"
    MIN = "min"
    MAX = "max"
    MOD = "mod"  # a - b * floor(a / b), as in GLSL
    POW = "pow"
    ATAN2 = "atan2"  # atan2(y, x)
    # booleans (scalars only)
    LESS = "less"
    LESS_EQUAL = "less_equal"
    EQUAL = "equal"
    AND = "and"
    OR = "or"
    NOT = "not"
    SELECT = "select"  # select(condition, then, else)


UNARY = frozenset(
    {Op.NEG, Op.ABS, Op.SIGN, Op.FLOOR, Op.ROUND, Op.SQRT, Op.SIN, Op.COS, Op.TAN, Op.ASIN, Op.ACOS, Op.ATAN}
    | {Op.EXP, Op.LOG}
)
BINARY = frozenset({Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.MIN, Op.MAX, Op.MOD, Op.POW, Op.ATAN2})
COMPARISON = frozenset({Op.LESS, Op.LESS_EQUAL, Op.EQUAL})
LOGIC = frozenset({Op.AND, Op.OR, Op.NOT})
LEAVES = frozenset({Op.CONST, Op.INPUT, Op.PARAM})
