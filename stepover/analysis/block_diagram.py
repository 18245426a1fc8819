"""Data flow between the units of Algorithm 1, read from the planner's source code: the content of Fig. 4.

A step is a call of a function whose docstring names its "step ... of Algorithm 1". The result of such a call is traced
to the steps that use it: through assignments, loops, the fields of dataclasses, and functions of the planner that call
steps themselves. So the diagram always agrees with the planner.
"""

from __future__ import annotations

import ast
import dataclasses
import inspect
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from stepover.planning.algorithm_1 import planner

NAMES = {
    1: ("FU", "feasibility unit"), 2: ("FTG", "feet trajectory generator"),
    3: ("CWTG1", "CoM and waist trajectory generator"), 4: ("IK", "inverse kinematics"),
    5: ("UBMG", "upper body motion generator"), 6: ("CWTG2", "second CWTG: the dynamic filter"),
    7: ("FTA", "feet trajectory adaptor"),
}  # fmt: skip
"""The paper's names of the steps."""
INPUT, OUTPUT = "obstacle", "Motion"
"""Input, a parameter of the planner, and output, a class."""
Product = tuple[str, str]
"""Unit that made a value, and the value's name in the planner; "" if it has no name yet."""
Value = set[Product] | dict[str, "Value"] | list["Value"]
"""Products in a value; for a dataclass, the products of each field; for a tuple, those of each part."""


@dataclass(frozen=True)
class Block:
    """One unit as the planner calls it.

    Attributes:
        name, meaning: the paper's abbreviation, and its full name.
        step: number in the printed algorithm.
        functions: functions that the planner calls, in their order.
    """

    name: str
    meaning: str
    step: int
    functions: tuple[str, ...]


@dataclass(frozen=True)
class Diagram:
    """Units in the order in which the planner calls them, and the values that flow between them.

    Attributes:
        blocks: the units.
        flows: names of the values, by maker and user. INPUT is a maker, OUTPUT a user.
    """

    blocks: tuple[Block, ...]
    flows: dict[tuple[str, str], tuple[str, ...]]


def diagram(source: str | None = None) -> Diagram:
    """Read the planner's source code.

    Args:
        source: source code to read instead.
    """
    text = ast.parse(source or inspect.getsource(planner))
    functions = {part.name: part for part in text.body if isinstance(part, ast.FunctionDef)}
    inner = {name: part for name, part in functions.items() if any(_step(call) for call in _calls(part))}
    reader = _Reader({name: part for name, part in inner.items() if not _step(name)})
    body = functions["algorithm_1"]
    known: dict[str, Value] = {INPUT: {(INPUT, INPUT)}}
    for name in _calls(functions["plan_in_detail"]):  # functions called there receive it as a parameter of its type
        if _step(name):
            reader.call(name, {(INPUT, INPUT)})
            given = str(inspect.signature(getattr(planner, name)).return_annotation)
            for argument in body.args.args:
                if re.search(rf"\b{ast.unparse(argument.annotation or argument)}\b", given):
                    known[argument.arg] = {(_name(name), argument.arg)}
    reader.run(body.body, known)
    blocks = [Block(*NAMES[step], step, tuple(names)) for step, names in reader.steps.items()]
    return Diagram(tuple(blocks), {pair: tuple(names) for pair, names in reader.flows.items()})


@dataclass
class _Reader:
    """Follows statements, with the products of each value in place of the value.

    Attributes:
        functions: functions of the planner that call steps, by name.
        steps: called functions, by step.
        flows: as in Diagram.
    """

    functions: dict[str, ast.FunctionDef]
    steps: dict[int, list[str]] = field(default_factory=dict)
    flows: dict[tuple[str, str], list[str]] = field(default_factory=dict)

    def run(self, body: Sequence[ast.stmt], known: dict[str, Value]) -> Value:
        """Follow statements in their order and update `known`. Returns the value of the last return."""
        result: Value = set()
        for statement in body:
            match statement:
                case ast.Assign(targets=[target]) | ast.AnnAssign(target=target) if statement.value:
                    _assign(target, self.made_of(statement.value, known), known)
                case ast.For() | ast.While():
                    self.run([*statement.body, *statement.body], known)
                case ast.If() | ast.Try():
                    self.run(statement.body, known)
                case ast.Expr(ast.Call(ast.Attribute(ast.Name(kept), "append"), [value])):
                    known[kept] = _products(known.get(kept, set())) | _products(self.made_of(value, known))
                case ast.Expr():
                    self.made_of(statement, known)
                case ast.Return() if statement.value:
                    result = self.made_of(statement.value, known)
        return result

    def made_of(self, node: ast.AST, known: dict[str, Value]) -> Value:
        """Products in an expression."""
        match node:
            case ast.Name(name):
                return known.get(name, set())
            case ast.Attribute(owner, part):
                return _part(self.made_of(owner, known), ast.unparse(owner).split(".")[-1], part)
            case ast.Tuple(parts):
                return [self.made_of(one, known) for one in parts]
            case ast.Call(ast.Name(name), positional, keywords):
                by_name = {one.arg or "": self.made_of(one.value, known) for one in keywords}
                return self._called(name, [self.made_of(one, known) for one in positional], by_name)
        children = [node.body, node.orelse] if isinstance(node, ast.IfExp) else ast.iter_child_nodes(node)
        return _products([self.made_of(child, known) for child in children])

    def _called(self, name: str, positional: list[Value], by_name: dict[str, Value]) -> Value:
        """Products of a call: a step's product, a dataclass's fields, or the result of a function of the planner."""
        made = getattr(planner, name, None)
        given = _products([*positional, *by_name.values()])
        if name == OUTPUT:
            self._flow(OUTPUT, given, first=True)
        elif _step(name):
            return self.call(name, given)
        elif name in self.functions:
            function = self.functions[name]
            parameters = [one.arg for one in function.args.args]
            return self.run(function.body, dict(zip(parameters, positional, strict=False)) | by_name)
        elif isinstance(made, type) and dataclasses.is_dataclass(made):
            fields = dict(zip([one.name for one in dataclasses.fields(made)], positional, strict=False)) | by_name
            return {own: _named(value, own) for own, value in fields.items()}
        return given

    def call(self, function: str, given: set[Product]) -> set[Product]:
        """Record the call of a step and the values that flow to it."""
        names = self.steps.setdefault(_step(function), [])
        first = function not in names
        names += [function] * first
        self._flow(_name(function), given, first)
        return {(_name(function), "")}

    def _flow(self, taker: str, given: set[Product], first: bool) -> None:
        """Record values that flow. If a step is called again, only values from later steps are new."""
        order = [NAMES[step][0] for step in self.steps]
        for maker, name in sorted(given):
            if maker != taker and (first or (maker in order and order.index(maker) > order.index(taker))):
                names = self.flows.setdefault((maker, taker), [])
                names += [name] * (name not in names)


def _assign(target: ast.expr, value: Value, known: dict[str, Value]) -> None:
    """Bind names. Products without a name get this name."""
    if isinstance(target, ast.Tuple) and isinstance(value, list):
        for one, part in zip(target.elts, value, strict=True):
            _assign(one, part, known)
    else:
        known[ast.unparse(target)] = _named(value, ast.unparse(target))


def _named(value: Value, name: str) -> Value:
    """The same value, with this name for its unnamed products."""
    return {(maker, known_as or name) for maker, known_as in value} if isinstance(value, set) else value


def _part(value: Value, name: str, part: str) -> Value:
    """A named attribute of a value: a field, or a product that gets the name of its part."""
    if isinstance(value, dict) and part in value:
        return value[part]
    return {(maker, part if known_as == name else known_as) for maker, known_as in _products(value)}


def _products(value: Value) -> set[Product]:
    """All products in a value."""
    if isinstance(value, set):
        return value
    parts = value.values() if isinstance(value, dict) else value
    return set[Product]().union(*(_products(part) for part in parts))


def _calls(function: ast.FunctionDef) -> Iterator[str]:
    """Names of the functions that a function calls, in their order."""
    for node in ast.walk(function):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            yield node.func.id


def _step(function: str) -> int:
    """Step of Algorithm 1 that a function of the planner performs, from its docstring; 0: none."""
    found = re.search(r"\bstep (\d) of Algorithm 1", getattr(planner, function, None).__doc__ or "")
    return int(found[1]) if found else 0


def _name(function: str) -> str:
    """The paper's abbreviation of a step."""
    return NAMES[_step(function)][0]
