"""Arithmetic expressions over parameters and, in signals, over the time t.

An expression is lowered to a postfix program of (operation, constant) pairs; what does not depend on t is
folded into a constant, so that a number written as an expression is a program of one constant.
"""

import ast
import math
import re
import warnings
from collections.abc import Callable, Mapping
from functools import lru_cache

from fmbd.model.names import did_you_mean, shortened, unknown

Program = list[tuple[str, float]]

MAX_LENGTH = 1000  # characters
MAX_DEPTH = 200  # nested operations
MAX_STACK = 64  # values that a program keeps at once

CONSTANTS = {"pi": math.pi, "e": math.e, "tau": math.tau}


class ExpressionError(ValueError):
    """An expression that cannot be read or has no finite value."""


def _sign(x: float) -> float:
    return float(x > 0) - float(x < 0)


def _modulo(a: float, b: float) -> float:
    return a % b


_BINARY: dict[str, Callable[[float, float], float]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "mod": _modulo,
    "pow": math.pow,
    "atan2": math.atan2,
    "hypot": math.hypot,
    "min": min,
    "max": max,
}
_UNARY: dict[str, Callable[[float], float]] = {
    "neg": lambda a: -a,
    "abs": abs,
    "sign": _sign,
    "floor": lambda a: float(math.floor(a)),
    "ceil": lambda a: float(math.ceil(a)),
} | {
    function.__name__: function
    for function in (
        *(math.sin, math.cos, math.tan, math.asin, math.acos, math.atan, math.sinh, math.cosh, math.tanh),
        *(math.exp, math.log, math.log10, math.sqrt, math.radians, math.degrees),
    )
}
# Functions of t that a program has no operation for: the operation and the constant that replace them.
_LOWERED: dict[str, Program] = {
    "log10": [("log", 0.0), ("const", math.log(10.0)), ("div", 0.0)],
    "radians": [("const", math.pi / 180.0), ("mul", 0.0)],
    "degrees": [("const", 180.0 / math.pi), ("mul", 0.0)],
}
_OPERATORS: dict[type[ast.AST], str] = {
    ast.Add: "add",
    ast.Sub: "sub",
    ast.Mult: "mul",
    ast.Div: "div",
    ast.Mod: "mod",
    ast.Pow: "pow",
    ast.USub: "neg",
}
_UNITS = r"[mcdk]?m|in|ft|[km]?g|t|k?N|[kMG]?Pa|m?s|Hz|m?V|m?A|deg|rad"
_has_unit = re.compile(rf"[-+]?[\d.]+(?:e[-+]?\d+)?\s*(?:(?:{_UNITS})\b.*|°)").fullmatch
_VARIADIC = ("min", "max")

FUNCTIONS = frozenset(_UNARY) - {"neg"} | {"atan2", "hypot", *_VARIADIC}
RESERVED_NAMES = FUNCTIONS | set(CONSTANTS) | {"t"}


def evaluate(text: str, parameters: Mapping[str, float]) -> float:
    """The finite value of an expression over `parameters`; raises ExpressionError."""
    program = _lower(_parse(text), parameters, time=False)
    return program[0][1]


def compile_time_expression(text: str, parameters: Mapping[str, float]) -> Program:
    """The postfix program of an expression in t [s] and `parameters`; raises ExpressionError.

    Operations: const t add sub mul div pow neg sin cos tan asin acos atan atan2 sinh cosh tanh exp log sqrt
    abs min max hypot sign floor ceil mod; `const` carries its value, the others 0. `a % b` has the sign of b.
    At most 64 values are on the stack at any moment.
    """
    program = _lower(_parse(text), parameters, time=True)
    if _stack_size(program) > MAX_STACK:
        raise ExpressionError(f"is nested too deeply: it needs more than {MAX_STACK} intermediate values")
    return program


def names_in(text: str) -> set[str]:
    """The names an expression refers to, functions and constants left out; raises ExpressionError."""
    return (
        {node.id for node in ast.walk(_parse(text)) if isinstance(node, ast.Name)}
        - FUNCTIONS
        - set(CONSTANTS)
    )


@lru_cache(maxsize=4096)
def _parse(text: str) -> ast.expr:
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"is an expression of {len(text)} characters; {MAX_LENGTH} are allowed")
    if not text.strip():
        raise ExpressionError("is empty where a number is needed")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        if _has_unit(text.strip()):
            advice = "write the number alone: lengths are in metres, angles in radians, all is in SI units"
            raise ExpressionError(f"'{shortened(text)}' has a unit: {advice}") from None
        raise ExpressionError(f"cannot read the expression '{shortened(text)}'") from None


def _lower(node: ast.expr, parameters: Mapping[str, float], time: bool, depth: int = 0) -> Program:
    """The program of a syntax tree."""
    if depth > MAX_DEPTH:
        raise ExpressionError(f"is nested too deeply: more than {MAX_DEPTH} operations within each other")
    match node:
        case ast.Constant(value=bool() | complex() | str() | bytes() | None):
            raise ExpressionError(f"'{ast.unparse(node)}' is not a number")
        case ast.Constant(value=int() | float() as value):
            return [("const", _finite(lambda: ast.unparse(node), float, value))]
        case ast.Name(id=name):
            return _value_of_name(name, parameters, time)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _lower(operand, parameters, time, depth + 1)
        case ast.UnaryOp(op=op, operand=operand) if type(op) in _OPERATORS:
            return _apply(_OPERATORS[type(op)], [_lower(operand, parameters, time, depth + 1)])
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            operands = [_lower(operand, parameters, time, depth + 1) for operand in (left, right)]
            return _apply(_OPERATORS[type(op)], operands)
        case ast.BinOp(op=ast.BitXor()):
            raise ExpressionError("'^' is not an operator here: write '**' for a power")
        case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
            _check_call(name, len(args))
            operands = [_lower(argument, parameters, time, depth + 1) for argument in args]
            return _apply(name, operands)
    raise ExpressionError("only numbers, parameters, + - * / % ** and functions are allowed in an expression")


def _value_of_name(name: str, parameters: Mapping[str, float], time: bool) -> Program:
    if time and name == "t":
        return [("t", 0.0)]
    if name in CONSTANTS:
        return [("const", CONSTANTS[name])]
    if name in parameters:
        return [("const", parameters[name])]
    if name == "t":
        raise ExpressionError("must not depend on the time t: only signals do")
    if name in FUNCTIONS:
        raise ExpressionError(f"the function '{name}' needs its argument in parentheses")
    switch = "; a switch is true or false" if name.lower() in ("yes", "no", "on", "off") else ""
    raise ExpressionError(unknown("name", name, parameters) + switch)


def _check_call(name: str, count: int) -> None:
    if name not in FUNCTIONS:
        raise ExpressionError(f"unknown function '{name}'{did_you_mean(name, FUNCTIONS)}")
    if name in _VARIADIC:
        if count == 0:
            raise ExpressionError(f"{name}() needs at least one argument")
    elif count != (2 if name in _BINARY else 1):
        raise ExpressionError(f"{name}() takes {2 if name in _BINARY else 1} argument(s), {count} given")


def _apply(operation: str, operands: list[Program]) -> Program:
    """The program of an operation on operands, folded when these are all constant."""
    if len(operands) > 2:
        operands = [_apply(operation, operands[:-1]), operands[-1]]
    elif operation in _VARIADIC and len(operands) == 1:
        return operands[0]
    program = [step for operand in operands for step in operand]
    if all(len(operand) == 1 and operand[0][0] == "const" for operand in operands):
        values = [value for _, value in program]
        function = _BINARY.get(operation) or _UNARY[operation]
        return [("const", _finite(lambda: _written(operation, values), function, *values))]
    return program + _LOWERED.get(operation, [(operation, 0.0)])


def _finite(text: Callable[[], str], function: Callable[..., float], *values: float) -> float:
    """function(*values); `text` says in a message what was computed."""
    try:
        result = function(*values)
    except ZeroDivisionError:
        raise ExpressionError(f"division by zero in {text()}") from None
    except (ValueError, OverflowError):
        result = math.nan
    if not math.isfinite(result):
        raise ExpressionError(f"{text()} has no finite value")
    return result


def _written(operation: str, values: list[float]) -> str:
    """How an operation on numbers reads in a message."""
    signs = {"add": "+", "sub": "-", "mul": "*", "div": "/", "mod": "%", "pow": "**"}
    numbers = [f"{value:g}" for value in values]
    if operation in signs:
        left, right = (f"({number})" if number.startswith("-") else number for number in numbers)
        return f"{left} {signs[operation]} {right}"
    return f"{operation}({', '.join(numbers)})"


def _stack_size(program: Program) -> int:
    size = largest = 0
    for operation, _ in program:
        size += 1 if operation in ("const", "t") else -1 if operation in _BINARY else 0
        largest = max(largest, size)
    return largest
