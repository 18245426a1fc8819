"""A robot from a robot.toml: what the file says is checked, and held against the URDF."""

from __future__ import annotations

import tomllib
from dataclasses import fields
from pathlib import Path
from types import MappingProxyType
from typing import Any, get_type_hints

from stepover.errors import InvalidInput
from stepover.locations import data_folder
from stepover.model.robot import Robot
from stepover.robots.checks import require_agreement
from stepover.robots.files import find_urdf
from stepover.robots.reading import read_section
from stepover.robots.urdf import read_urdf


def load_robot(robot: str | Path) -> Robot:
    """Load a robot by name (a folder under data/) or by the path of a robot.toml.

    Raises:
        InvalidInput: unknown name, unreadable file, a key that is missing or makes no sense, a joint or link
            that the URDF lacks. The message names it.
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
        table = tomllib.loads(path.read_text())
    except OSError as error:
        raise InvalidInput(f"{path} cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InvalidInput(f"{path} is not valid TOML: {error}") from error
    try:
        parts = _read(table)
        urdf_path = find_urdf(parts.pop("urdf"), path.parent.resolve())
        description, _ = read_urdf(urdf_path)
        found = Robot(urdf_path=urdf_path, description=description, **parts)
        require_agreement(found)
        return found
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from error


def _read(table: dict[str, Any]) -> dict[str, Any]:
    """Check the top level of robot.toml and each of its tables."""
    hints = get_type_hints(Robot) | {"urdf": str}
    names = [
        "urdf" if field.name == "urdf_path" else field.name for field in fields(Robot) if field.name != "description"
    ]
    for key in names:
        if key not in table:
            raise InvalidInput(f"lacks the {'key' if hints[key] is str else 'table'} {key!r}")
    for key in table:
        if key not in names:
            raise InvalidInput(f"has an unknown key {key!r}; known are {', '.join(names)}")
    texts = {key: table[key] for key in names if hints[key] is str}
    sections = [key for key in names if key not in texts and key != "slow"]
    for key, text in texts.items():
        if not isinstance(text, str) or not text:
            raise InvalidInput(f"{key} = {text!r} must be a name")
    whole = {key: read_section(hints[key], table[key], key) for key in sections}
    slow = {
        key: read_section(hints[key], table[key] | part, f"slow.{key}")
        for key, part in _changes(table["slow"], sections).items()
    }
    return texts | whole | {"slow": MappingProxyType(slow)}


def _changes(slow: Any, sections: list[str]) -> dict[str, dict[str, Any]]:
    """The tables under slow, each named as the one that it changes."""
    if not isinstance(slow, dict):
        raise InvalidInput("slow must be a table")
    for key, part in slow.items():
        if key not in sections:
            raise InvalidInput(f"slow has an unknown key {key!r}; known are {', '.join(sections)}")
        if not isinstance(part, dict):
            raise InvalidInput(f"slow.{key} must be a table")
    return slow
