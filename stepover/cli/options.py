"""Options that several commands share, each said once, and the checks of what they are given."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from stepover.errors import InvalidInput

Option = Callable[[Any], Any]
as_json = click.option("--json", "as_json", is_flag=True, help="Print one JSON object (SI units), not the summary.")
motion_file = click.argument("motion", metavar="MOTION.npz")


def together(*options: Option) -> Option:
    """Several options as one decorator, in the order in which the help lists them."""

    def decorate(command: Any) -> Any:
        for option in reversed(options):
            command = option(command)
        return command

    return decorate


def choice(name: str, values: tuple[str, ...], help: str, default: str | None = None) -> Option:
    """An option with few values, of which the first is the default unless another one is given."""
    return click.option(name, type=click.Choice(values), default=default or values[0], show_default=True, help=help)


def robot_file(command: Any) -> Any:
    """Where a motion's robot is to be found."""
    explained = "Path to the robot.toml of a robot that is none under data/."
    return click.option("--robot", metavar="TOML", help=explained)(command)


margins = together(
    click.option("--margin-height", type=float, default=0.03, show_default=True, help="Safety margin above it [m]."),
    click.option("--margin-width", type=float, default=0.03, show_default=True, help="Before and behind it [m]."),
)
planner_choices = together(
    choice("--arms", ("auto", "on", "off"), "Swing the arms back: where the plan needs it, always, never."),
    choice("--speed-limits", ("ignore", "respect"), "The joints' speed limits; the paper ignores them."),
)


def physics(actuators: str = "ideal", sole: str = "rigid") -> Option:
    """Motors and soles of the simulated robot, with their defaults."""
    return together(
        choice(
            "--actuators", ("ideal", "limited"), default=actuators,
            help="Motors that follow without limits, as in the paper, or servos with limited torque, less at speed.",
        ),
        choice("--sole", ("rigid", "compliant"), "Rigid soles, or rubber between ankle and sole.", default=sole),
    )  # fmt: skip


def new_file(name: str, help: str, suffix: str = "", **settings: Any) -> Option:
    """An option that names a file to be written; refused before the work begins if it could not be written after it.

    Args:
        name: of the option.
        help: what goes there; the suffix, where there is one, is added.
        suffix: that its name must have, such as ".png".
        **settings: of click.option.
    """

    def check(context: click.Context, parameter: click.Parameter, value: str | None) -> Path | None:
        return None if value is None else _writable(f"--{parameter.name}", Path(value), suffix)

    explained = f"{help} ({suffix.removeprefix('.')})." if suffix else f"{help}."
    return click.option(name, metavar="FILE", callback=check, help=explained, **settings)


def _writable(option: str, path: Path, suffix: str) -> Path:
    """The path of a file that can be written, as far as one can see."""
    if path.is_dir():
        raise InvalidInput(f"{option} {path} is a folder; name a file in it")
    if suffix and path.suffix != suffix:
        raise InvalidInput(f"{option} {path}: the file's name must end in {suffix}")
    if not path.parent.is_dir():
        raise InvalidInput(f"{option} {path}: the folder {path.parent} does not exist; make it first")
    if not os.access(path.parent, os.W_OK):
        raise InvalidInput(f"{option} {path}: the folder {path.parent} cannot be written to")
    return path


def pairs(context: click.Context, parameter: click.Parameter, values: tuple[str, ...]) -> dict[str, str]:
    """Split name=value pairs, and refuse what is none or comes twice."""
    found: dict[str, str] = {}
    for value in values:
        name, equals, text = value.partition("=")
        if not (name and equals and text):
            raise InvalidInput(f"{value!r} is not name=value")
        if name in found:
            raise InvalidInput(f"{name} is given twice: {found[name]} and {text}")
        found[name] = text
    return found
