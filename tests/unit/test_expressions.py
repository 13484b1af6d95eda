"""Arithmetic in the model file: numbers over parameters, and programs in the time t."""

import ast
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fmbd.model.expressions import MAX_STACK, ExpressionError, compile_time_expression, evaluate

PARAMETERS = {"l1": 0.4, "l2": 0.5, "n": 3.0}

ONE = {
    "neg": lambda a: -a,
    "abs": abs,
    "sign": lambda a: math.copysign(1.0, a) if a else 0.0,
    "floor": math.floor,
    "ceil": math.ceil,
}
ONE |= {f.__name__: f for f in (math.sin, math.cos, math.tan, math.asin, math.acos, math.atan, math.sqrt)}
ONE |= {f.__name__: f for f in (math.sinh, math.cosh, math.tanh, math.exp, math.log)}
TWO = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "mod": lambda a, b: a % b,
    "pow": math.pow,
    "atan2": math.atan2,
    "hypot": math.hypot,
    "min": min,
    "max": max,
}


def run(program, t):
    """A stack machine as plain as can be."""
    stack = []
    for operation, constant in program:
        if operation == "const":
            stack.append(constant)
        elif operation == "t":
            stack.append(t)
        elif operation in ONE:
            stack.append(ONE[operation](stack.pop()))
        else:
            b, a = stack.pop(), stack.pop()
            stack.append(TWO[operation](a, b))
    (result,) = stack
    return result


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("l2/2", 0.25),
        ("-l1**2", -0.16),
        ("2**3**2", 512.0),
        ("(l1 + l2)*n - 7 % 4", 0.9 * 3 - 3),
        ("-7 % 3", 2.0),
        ("+1e-3", 0.001),
        ("sin(pi/6) + cos(tau/3)", 0.0),
        ("log10(1000)", 3.0),
        ("log(e)", 1.0),
        ("degrees(pi) - radians(180)", 180.0 - math.pi),
        ("atan2(1, -1)", 0.75 * math.pi),
        ("hypot(3, 4)", 5.0),
        ("min(3, 1, 2) + max(4)", 5.0),
        ("floor(-0.5) + ceil(0.5) + sign(-2) + abs(-3)", 2.0),
        ("sinh(1) + cosh(1) - exp(1) + tanh(0) + asin(1) - acos(0) + atan(0) + sqrt(4) - tan(0)", 2.0),
        ("  l1\n", 0.4),
    ],
)
def test_a_number_may_be_an_expression(text, value):
    assert evaluate(text, PARAMETERS) == pytest.approx(value, rel=1e-14, abs=1e-15)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("l3", "unknown name 'l3' (known: l1, l2, n)"),
        ("lenght", "unknown name 'lenght'"),
        ("sine(1)", "unknown function 'sine', did you mean 'sin'?"),
        ("sin", "the function 'sin' needs its argument in parentheses"),
        ("sin(1, 2)", "sin() takes 1 argument(s), 2 given"),
        ("hypot(1)", "hypot() takes 2 argument(s), 1 given"),
        ("max()", "max() needs at least one argument"),
        ("t", "must not depend on the time t: only signals do"),
        ("1/(l1 - 0.4)", "division by zero in 1 / 0"),
        ("sqrt(-1)", "sqrt(-1) has no finite value"),
        ("(-8)**(1/3)", "(-8) ** 0.333333 has no finite value"),
        ("9**9**9**9", "has no finite value"),
        ("1e999", "has no finite value"),
        ("9" * 400, "has no finite value"),
        ("2^3", "write '**' for a power"),
        ("2 l1", "cannot read the expression '2 l1'"),
        ("(" * 500, "cannot read the expression"),
        ("-" * 990 + "1", ""),
        ("+".join("1" * 400), "nested too deeply"),
        ("1" * 1001, "1001 characters; 1000 are allowed"),
        ("   ", "is empty where a number is needed"),
        ("True", "'True' is not a number"),
        ("1j", "'1j' is not a number"),
        ("'a'*10**9", "is not a number"),
        ("1 if n else 2", "only numbers, parameters"),
        ("[1][0]", "only numbers, parameters"),
        ("l1.real", "only numbers, parameters"),
        ("__import__('os')", "unknown function '__import__'"),
        ("abs(*[1])", "only numbers, parameters"),
        ("7 // 2", "only numbers, parameters"),
        ("n := 3", "cannot read the expression"),
        ("\0", "cannot read the expression"),
    ],
)
def test_what_is_not_a_number_is_refused_with_the_reason(text, message):
    with pytest.raises(ExpressionError) as error:
        evaluate(text, PARAMETERS)
    assert message in str(error.value)


def test_what_does_not_depend_on_time_is_folded_into_constants():
    program = compile_time_expression("l1*sin(2*pi*n*t) + cos(pi)", PARAMETERS)
    assert program == [
        ("const", 0.4),
        ("const", 6 * math.pi),
        ("t", 0.0),
        ("mul", 0.0),
        ("sin", 0.0),
        ("mul", 0.0),
        ("const", -1.0),
        ("add", 0.0),
    ]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("log10(t)", lambda t: math.log10(t)),
        ("radians(t) + degrees(t)", lambda t: math.radians(t) + math.degrees(t)),
        ("min(t, 2, 3*t) - max(1, t)", lambda t: min(t, 2, 3 * t) - max(1, t)),
        ("-(t - 1) % 0.4 / t", lambda t: -(t - 1) % 0.4 / t),
        ("t**2 + hypot(t, 1) + atan2(t, 2)", lambda t: t**2 + math.hypot(t, 1) + math.atan2(t, 2)),
        (
            "floor(t) + ceil(t) + sign(t - 1) + abs(-t)",
            lambda t: 2 * math.floor(t) + 1 + (t > 1) - (t < 1) + t,
        ),
    ],
)
@pytest.mark.parametrize("t", [0.3, 1.7])
def test_a_program_gives_what_the_expression_says(text, value, t):
    assert run(compile_time_expression(text, {}), t) == pytest.approx(value(t), rel=1e-14)


def test_a_program_that_would_need_a_deep_stack_is_refused():
    fits = "t+(" * (MAX_STACK - 1) + "t" + ")" * (MAX_STACK - 1)
    assert run(compile_time_expression(fits, {}), 0.5) == 0.5 * MAX_STACK
    with pytest.raises(ExpressionError, match="more than 64 intermediate values"):
        compile_time_expression(f"t+({fits})", {})


expressions = st.recursive(
    st.sampled_from(["t", "l1", "n", "pi", "2", "0.5"]),
    lambda inner: st.one_of(
        st.builds("({}{}{})".format, inner, st.sampled_from("+-*/%"), inner),
        st.builds("(-{})".format, inner),
        st.builds("{}({})".format, st.sampled_from(["sin", "cos", "atan", "tanh", "abs"]), inner),
        st.builds("{}({},{})".format, st.sampled_from(["min", "max", "hypot", "atan2"]), inner, inner),
    ),
    max_leaves=12,
)


@given(expressions, st.floats(0.1, 10))
def test_any_program_agrees_with_python(text, t):
    """The same text, evaluated by Python itself with the functions of the math module."""
    names = {**vars(math), **PARAMETERS, "t": t, "min": min, "max": max, "abs": abs}
    try:
        expected = eval(compile(ast.parse(text, mode="eval"), "", "eval"), names)
        program = compile_time_expression(text, PARAMETERS)
        result = run(program, t)
    except (ZeroDivisionError, ExpressionError):
        return
    assert result == pytest.approx(expected, rel=1e-12, abs=1e-12)


@given(st.text(max_size=60))
def test_any_text_is_a_program_or_an_expression_error(text):
    try:
        program = compile_time_expression(text, PARAMETERS)
    except ExpressionError:
        return
    assert program
