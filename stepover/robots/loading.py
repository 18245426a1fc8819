"""A robot from a robot.toml: its facts are checked and compared with the URDF, its parameters get their defaults."""

from __future__ import annotations

import tomllib
from dataclasses import MISSING, fields, is_dataclass, replace
from math import nan
from pathlib import Path
from types import MappingProxyType
from typing import Any, get_type_hints

from stepover.errors import InvalidInput
from stepover.locations import data_folder
from stepover.model.body import Body
from stepover.model.parameters.facts import Posture
from stepover.model.parameters.scaling import scaled
from stepover.model.parameters.slow import SLOW
from stepover.model.robot import Robot
from stepover.robots.checks import (
    require_apart,
    require_joints,
    require_room_to_sink,
    require_standing,
    require_whole_steps,
)
from stepover.robots.derived import com_height, standing
from stepover.robots.files import find_file, read_text
from stepover.robots.reading import WrongEntry, line_of, read_section, require_known
from stepover.robots.urdf import read_urdf

MOST_BYTES = 1_000_000
"""Largest robot.toml that is read."""
TEXTS = ("name", "urdf", "root")
_KINDS: dict[str, type[Any]] = get_type_hints(Robot)
_TABLES = [field for field in fields(Robot) if is_dataclass(_KINDS[field.name])]
FACTS = {field.name: _KINDS[field.name] for field in _TABLES if field.default_factory is MISSING}
"""The tables that every robot.toml has, and their dataclasses."""
PARAMETERS = {field.name: _KINDS[field.name] for field in _TABLES if field.default_factory is not MISSING}
"""The tables that a robot.toml may have: it names what differs from the defaults."""


def load_robot(robot: str | Path) -> Robot:
    """Load a robot by name (a folder under data/) or by the path of a robot.toml.

    Raises:
        InvalidInput: unknown name, unreadable file, a key that is missing or makes no sense, a joint or link
            that the URDF lacks. The message names it, and the line of the file where there is one.
    """
    path = Path(robot)
    if path.suffix != ".toml":
        known = sorted(file.parent.name for file in data_folder().glob("*/robot.toml"))
        if str(robot) not in known:
            inside = f", such as {path / 'robot.toml'}" if (path / "robot.toml").is_file() else ""
            raise InvalidInput(
                f"unknown robot {str(robot)!r}: known are {', '.join(known)}, or give a path to a robot.toml{inside}"
            )
        path = data_folder() / str(robot) / "robot.toml"
    try:
        text = read_text(path, MOST_BYTES)
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        if isinstance(error, InvalidInput):
            raise
        raise InvalidInput(f"{path} is not valid TOML: {error}") from error
    try:
        return _robot(table, path.parent.resolve())
    except WrongEntry as error:
        lines = [line for place in error.places if (line := line_of(text, place))]
        raise InvalidInput(f"{path}: {f'line {lines[0]}: ' if lines else ''}{error}") from error
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from error


def _robot(table: dict[str, Any], folder: Path) -> Robot:
    """The robot of a robot.toml: its facts first, then what the model derives from them, then the parameters."""
    name, urdf, root = (_text(table, key) for key in TEXTS)
    for key in FACTS:
        if key not in table:
            raise WrongEntry(f"lacks the table {key!r}")
    require_known(table, [*TEXTS, *FACTS, *PARAMETERS, "slow"])
    path = find_file(urdf, folder)
    unknown = dict.fromkeys(("waist_height", "feet_apart"), nan)
    facts = {
        key: read_section(kind, table[key], key, unknown if key == "posture" else {}) for key, kind in FACTS.items()
    }
    bare = Robot(name=name, urdf_path=path, body=Body(read_urdf(path)[0]), root=root, **facts)
    require_joints(bare)
    bare = replace(bare, posture=read_section(Posture, table["posture"], "posture", standing(bare)))
    require_standing(bare)
    require_apart(bare)
    given = {key: table.get(key, {}) for key in PARAMETERS}
    tables = {key: read_section(kind, given[key], key, _defaults(bare, key)) for key, kind in PARAMETERS.items()}
    robot = replace(bare, **tables)
    require_room_to_sink(robot)
    require_whole_steps(robot)
    return replace(robot, slow=MappingProxyType(_slow(robot, given)) if _is_slowed(table) else {})


def _text(table: dict[str, Any], key: str) -> str:
    """A name at the top of robot.toml."""
    if key not in table:
        raise WrongEntry(f"lacks the key {key!r}")
    if not isinstance(table[key], str) or not table[key]:
        raise WrongEntry(f"{key} = {table[key]!r} must be a name", key)
    return str(table[key])


def _is_slowed(table: dict[str, Any]) -> bool:
    """Whether motions that keep the speed limits take the slow parameters: unless robot.toml says slow = false."""
    slow = table.get("slow", True)
    if not isinstance(slow, bool):
        raise WrongEntry("slow must be true or false: its values are defaults of the library", "slow")
    return slow


def _defaults(robot: Robot, table: str) -> dict[str, Any]:
    """The defaults of a table for a robot whose facts are known."""
    known = {"com_height": com_height(robot)} if table == "preview" else {}
    return scaled(PARAMETERS[table], robot.size) | known


def _slow(robot: Robot, given: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """The tables of a robot that keeps the speed limits: the slow parameters take the place of its own."""
    tables = {}
    for key, values in SLOW.items():
        kept = {name: value for name, value in given[key].items() if name not in values}
        slow = scaled(PARAMETERS[key], robot.size, values)
        tables[key] = read_section(PARAMETERS[key], kept, key, _defaults(robot, key) | slow)
    return tables
