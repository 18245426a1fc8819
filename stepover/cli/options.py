"""Options that several commands share, and the checks of their values."""

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
    """An option with a few allowed values. The first is the default unless another is given."""
    return click.option(name, type=click.Choice(values), default=default or values[0], show_default=True, help=help)


def robot_file(command: Any) -> Any:
    """Where to find the robot of a motion."""
    explained = "Path to the robot.toml, for a robot outside data/."
    return click.option("--robot", metavar="TOML", help=explained)(command)


margins = together(
    click.option(
        "--margin-height", type=float, default=0.03, show_default=True, help="Safety margin above the obstacle [m]."
    ),
    click.option(
        "--margin-width",
        type=float,
        default=0.03,
        show_default=True,
        help="Safety margin before and behind the obstacle [m].",
    ),
)
planner_choices = together(
    choice("--arms", ("auto", "on", "off"), "Swing the arms back: if the plan needs it, always, or never."),
    choice("--speed-limits", ("ignore", "respect"), "Ignore the joints' speed limits, as in the paper, or keep them."),
)


engine = choice("--engine", ("pybullet", "mujoco"), "The physics engine.")


def physics(actuators: str = "ideal", sole: str = "rigid") -> Option:
    """Motors and soles of the simulated robot, with their defaults."""
    return together(
        choice(
            "--actuators", ("ideal", "limited"), default=actuators,
            help="Ideal motors without limits, as in the paper, or servos whose torque drops near the speed limit.",
        ),
        choice("--sole", ("rigid", "compliant"), "Rigid soles, or rubber between ankle and sole.", default=sole),
        engine,
    )  # fmt: skip


def new_file(name: str, help: str, suffix: str = "", **settings: Any) -> Option:
    """An option that names an output file. A path that cannot be written is rejected before the work begins.

    Args:
        name: name of the option.
        help: what the file contains; the suffix is added to the text if there is one.
        suffix: required ending of the file's name, such as ".png".
        **settings: passed to click.option.
    """

    def check(context: click.Context, parameter: click.Parameter, value: str | None) -> Path | None:
        return None if value is None else _writable(f"--{parameter.name}", Path(value), suffix)

    explained = f"{help} ({suffix.removeprefix('.')})." if suffix else f"{help}."
    return click.option(name, metavar="FILE", callback=check, help=explained, **settings)


def _writable(option: str, path: Path, suffix: str) -> Path:
    """The path, if a file can be written there."""
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
    """Split name=value pairs. Reject other texts and repeated names."""
    found: dict[str, str] = {}
    for value in values:
        name, equals, text = value.partition("=")
        if not (name and equals and text):
            raise InvalidInput(f"{value!r} is not name=value")
        if name in found:
            raise InvalidInput(f"{name} is given twice: {found[name]} and {text}")
        found[name] = text
    return found
