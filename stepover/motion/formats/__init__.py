"""File formats of a motion, one module each. The module has the name of the format, with "_" instead of "-".

A format is a module in this folder with a function `export(motion, path)`. No other file needs to know it.
"""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

from stepover.errors import InvalidInput


def known() -> list[str]:
    """Names of all formats, in alphabetical order."""
    return sorted(module.name.replace("_", "-") for module in iter_modules(__path__))


def find(name: str) -> ModuleType:
    """The module of a format.

    Raises:
        InvalidInput: there is no such format. The message lists the known formats.
    """
    if name not in known():
        raise InvalidInput(f"unknown format {name!r}: known are {', '.join(known())}")
    return import_module(f"{__name__}.{name.replace('-', '_')}")
