"""What feeds what in Algorithm 1, read from the planner's own text: the content of Fig. 4.

A step is a call of a function whose docstring says which "step ... of Algorithm 1" it is. What such a call gives is
followed through assignments, loops and other calls to the steps that take it. So the diagram cannot tell another
story than the planner.
"""

from __future__ import annotations

import ast
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
"""What goes in: a parameter; what comes out: a class."""
Product = tuple[str, str]
"""Who made it, and under which name the planner knows it; "" before it has one."""


@dataclass(frozen=True)
class Block:
    """One unit as the planner calls it.

    Attributes:
        name, meaning: the paper's abbreviation, and what it stands for.
        step: number in the printed algorithm.
        functions: that the planner calls, in their order.
    """

    name: str
    meaning: str
    step: int
    functions: tuple[str, ...]


@dataclass(frozen=True)
class Diagram:
    """Units in the order in which the planner calls them, and what each hands to another.

    Attributes:
        blocks: the units.
        flows: names of what flows, by who makes it and who takes it; INPUT makes and OUTPUT takes.
    """

    blocks: tuple[Block, ...]
    flows: dict[tuple[str, str], tuple[str, ...]]


def diagram(source: str | None = None) -> Diagram:
    """Read the planner.

    Args:
        source: text to read in its place.
    """
    text = ast.parse(source or inspect.getsource(planner))
    functions = {part.name: part for part in text.body if isinstance(part, ast.FunctionDef)}
    reader = _Reader()
    body = functions["algorithm_1"]
    known: dict[str, set[Product]] = {INPUT: {(INPUT, INPUT)}}
    for name in _calls(functions["plan_in_detail"]):  # what is called there comes in as a parameter of its type
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
    """Runs through statements with sets of products in place of values."""

    steps: dict[int, list[str]] = field(default_factory=dict)
    flows: dict[tuple[str, str], list[str]] = field(default_factory=dict)

    def run(self, body: Sequence[ast.stmt], known: dict[str, set[Product]]) -> None:
        """Follow statements in their order; known is brought up to date."""
        for statement in body:
            match statement:
                case ast.Assign(targets=[target]) | ast.AnnAssign(target=target) if statement.value:
                    self._assign(target, statement.value, known)
                case ast.For() | ast.While():
                    self.run([*statement.body, *statement.body], known)
                case ast.If() | ast.Try():
                    self.run(statement.body, known)
                case ast.Expr(ast.Call(ast.Attribute(ast.Name(kept), "append"), [value])):
                    known[kept] = known.get(kept, set()) | self.made_of(value, known)
                case ast.Expr() | ast.Return():
                    self.made_of(statement, known)

    def made_of(self, node: ast.AST, known: dict[str, set[Product]]) -> set[Product]:
        """Products that go into an expression; a step's own call is what it gives."""
        match node:
            case ast.Name(name):
                return known.get(name, set())
            case ast.Attribute(ast.Name(name), part):
                return {(maker, part if known_as == name else known_as) for maker, known_as in known.get(name, set())}
        children = [node.body, node.orelse] if isinstance(node, ast.IfExp) else ast.iter_child_nodes(node)
        found = set[Product]().union(*(self.made_of(child, known) for child in children))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            if node.func.id == OUTPUT:
                self._flow(OUTPUT, found, first=True)
            elif _step(node.func.id):
                return self.call(node.func.id, found)
        return found

    def call(self, function: str, given: set[Product]) -> set[Product]:
        """A step is called: note it, and what flows to it."""
        names = self.steps.setdefault(_step(function), [])
        first = function not in names
        names += [function] * first
        self._flow(_name(function), given, first)
        return {(_name(function), "")}

    def _flow(self, taker: str, given: set[Product], first: bool) -> None:
        """Note what flows; when a step is called once more, only what comes back from a later one is new."""
        order = [NAMES[step][0] for step in self.steps]
        for maker, name in sorted(given):
            if maker != taker and (first or (maker in order and order.index(maker) > order.index(taker))):
                names = self.flows.setdefault((maker, taker), [])
                names += [name] * (name not in names)

    def _assign(self, target: ast.expr, value: ast.expr, known: dict[str, set[Product]]) -> None:
        """Bind names; what has none yet gets this one."""
        if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
            made = [self.made_of(one, known) for one in value.elts]
            known |= {ast.unparse(one): made_of for one, made_of in zip(target.elts, made, strict=True)}
        else:
            name = ast.unparse(target)
            known[name] = {(maker, known_as or name) for maker, known_as in self.made_of(value, known)}


def _calls(function: ast.FunctionDef) -> Iterator[str]:
    """Names of the functions that a function calls, in their order."""
    for node in ast.walk(function):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            yield node.func.id


def _step(function: str) -> int:
    """Which step of Algorithm 1 a function of the planner is, by its docstring; 0: none."""
    found = re.search(r"\bstep (\d) of Algorithm 1", getattr(planner, function, None).__doc__ or "")
    return int(found[1]) if found else 0


def _name(function: str) -> str:
    """The paper's abbreviation for it."""
    return NAMES[_step(function)][0]
