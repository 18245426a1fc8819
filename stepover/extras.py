"""The optional libraries: which extra of the package brings which, and what is said where one is missing."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from stepover.errors import InvalidInput

EXTRAS = {
    "IPython": "notebooks",
    "PIL": "report",
    "dask": "dask",
    "distributed": "dask",
    "imageio_ffmpeg": "report",
    "ipywidgets": "notebooks",
    "joblib": "studies",
    "jupyter_client": "notebooks",
    "matplotlib": "report",
    "meshcat": "report",
    "nbformat": "notebooks",
    "papermill": "notebooks",
    "pybullet": "pybullet",
    "pybullet_data": "pybullet",
    "pybullet_utils": "pybullet",
}
"""The extra in pyproject.toml that installs each module which planning can do without."""
NAMES = {
    "PIL": "Pillow",
    "pybullet": "PyBullet",
    "pybullet_data": "PyBullet",
    "pybullet_utils": "PyBullet",
}
"""Libraries that are called otherwise than their module."""
INSTEAD = {"simulate": "or take --engine mujoco"}
"""What does without the missing library, by what needs it."""
LAST_PYTHON = {"pybullet": (3, 11)}
"""The last Python for which there are wheels of an extra."""


@contextmanager
def needs(what: str) -> Iterator[None]:
    """Import optional libraries inside; where one is missing, one line names the extra that installs it.

    Args:
        what: needs them: the first words of the message, such as "simulate".

    Raises:
        InvalidInput: "simulate needs PyBullet: pip install 'stepover[pybullet]', or take --engine mujoco".
    """
    try:
        yield
    except ModuleNotFoundError as error:
        module = (error.name or "").partition(".")[0]
        if module not in EXTRAS:
            raise
        raise InvalidInput(f"{what} needs {NAMES.get(module, module)}{_remedy(what, EXTRAS[module])}") from error


def _remedy(what: str, extra: str) -> str:
    """How an extra is installed, with which Python where this one is too new for it, and what does without it."""
    command = f": pip install 'stepover[{extra}]'"
    last = LAST_PYTHON.get(extra, sys.version_info[:2])
    if sys.version_info[:2] > last:
        newest, this = (".".join(map(str, version[:2])) for version in (last, sys.version_info))
        command = f", which has no wheel for Python {this}{command} under Python {newest}"
    return f"{command}, {INSTEAD[what]}" if what in INSTEAD else command
