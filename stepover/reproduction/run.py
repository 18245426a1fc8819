"""The reproduction run: every notebook through papermill, every figure to its place. The only door to papermill.

A notebook writes into a staging folder. When the whole notebook has succeeded, the files move to figures/. A run that
fails or is killed leaves the old figures unchanged. The records of the claims are gathered at the end, when all
notebooks have succeeded. An experiment may run beside the reference; two of a kind may not.
"""

from __future__ import annotations

import ast
import math
import os
import shutil
from pathlib import Path
from typing import Any

from stepover.errors import InvalidInput, StepOverError
from stepover.output import alone
from stepover.reproduction.kernel import own_kernel
from stepover.reproduction.verdicts import gather, take_records

OUTPUT = "output"
"""The parameter for the folder of a notebook's figures. The run sets it; a user cannot."""
EXIT_CODES = {"Infeasible": 3, "InvalidInput": 2, "CorruptMotion": 2}
"""Exit codes by the error of the failing cell; 1 for any other error."""


class NotebookFailed(StepOverError):
    """A cell of a notebook raised an error. The message names notebook and cell.

    Attributes:
        exit_code: of the command line.
    """

    def __init__(self, message: str, exit_code: int = 1) -> None:
        """Store message and exit code."""
        self.exit_code = exit_code
        super().__init__(message)


def reproduce(top: Path, only: str | None = None, parameters: dict[str, str] | None = None) -> list[Path]:
    """Run the notebooks of a checkout, move their figures to their place, and gather what they recorded.

    With your own parameters the figures go to build/figures/ and the executed copies to build/experiment/. If a
    notebook fails then, the others still run.

    Args:
        top: the checkout, with notebooks/.
        only: name of the one notebook to run, with or without .ipynb or its folder.
        parameters: your values of notebook parameters, by name.

    Returns:
        The files that were written: the figures and, without own parameters, figures/claims.json and its pages.

    Raises:
        InvalidInput: an unknown notebook or parameter, a value of the wrong type, or another run of the same kind is
            at work: nothing has run then. Or records and data/claims.toml disagree: the old claims stay unchanged.
        NotebookFailed: names notebook, cell and error. The old figures of that notebook stay unchanged. With own
            parameters it names all notebooks that failed, after the others have run, and has the largest exit code.
    """
    notebooks = find_notebooks(top, only)
    values = _own_values(notebooks, parameters or {})
    kind = "experiment" if parameters else "reference"
    with alone(top / "build" / f"{kind}.lock", f"{'build/figures/' if parameters else 'figures/'} is being written"):
        return _run_all(top, notebooks, values, kind, whole=only is None)


def _run_all(
    top: Path, notebooks: list[Path], values: dict[Path, dict[str, Any]], kind: str, whole: bool
) -> list[Path]:
    """Run notebooks one after the other, for the reference or an experiment. The files that were written."""
    experiment = kind == "experiment"
    place = top / "build" / "figures" if experiment else top / "figures"
    copies = top / "build" / ("experiment" if experiment else "notebooks")
    written, recorded, failed = list[Path](), {}, list[NotebookFailed]()
    for k, notebook in enumerate(notebooks, start=1):
        staging = top / "build" / "staging" / kind / notebook.stem
        label = f"{k} of {len(notebooks)}: {notebook.stem}" if len(notebooks) > 1 else ""
        try:
            shutil.rmtree(staging, ignore_errors=True)
            staging.mkdir(parents=True)
            run_notebook(notebook, copies / notebook.name, staging, values[notebook], label)
            if not experiment:
                recorded[notebook.stem] = take_records(staging)
            written += _move(staging, place)
        except OSError as error:
            raise NotebookFailed(f"notebook {notebook.stem}: {error}") from error
        except NotebookFailed as error:
            if not experiment:
                raise
            failed.append(error)
    if failed:
        done = (
            f"{len(failed)} of {len(notebooks)} notebooks failed with these parameters; the others ran: "
            if len(notebooks) > 1
            else ""
        )
        raise NotebookFailed(done + "; ".join(map(str, failed)), max(error.exit_code for error in failed))
    return written if experiment else written + gather(top, recorded, whole)


def find_notebooks(top: Path, only: str | None = None) -> list[Path]:
    """The notebooks of a checkout in alphabetical order, or only the named one."""
    found = sorted((top / "notebooks").glob("*.ipynb"))
    if not found:
        raise InvalidInput(f"no notebooks in {top / 'notebooks'}")
    if only is None:
        return found
    name = Path(only).name.removesuffix(".ipynb")
    if name not in (notebook.stem for notebook in found):
        raise InvalidInput(f"unknown notebook {only!r}: known are {', '.join(n.stem for n in found)}")
    return [notebook for notebook in found if notebook.stem == name]


def run_notebook(notebook: Path, executed: Path, output: Path, values: dict[str, Any], label: str = "") -> None:
    """Run one notebook with a progress bar and keep the executed copy, even if it fails. The default label is its name.

    Raises:
        NotebookFailed: a cell raised an error, or the kernel could not be started or died.
    """
    os.environ.setdefault("PYDEVD_DISABLE_FILE_VALIDATION", "1")  # or each kernel prints a debugger's warning
    import papermill

    executed.parent.mkdir(parents=True, exist_ok=True)
    own = values | ({OUTPUT: str(output)} if OUTPUT in parameters_of(notebook) else {})
    try:
        papermill.execute_notebook(
            notebook, executed, own, kernel_name="python3", kernel_manager_class=own_kernel(), cwd=notebook.parent,
            progress_bar={"desc": label or notebook.stem, "unit": "cell"}, extra_arguments=["--log-level=CRITICAL"],
        )  # fmt: skip
    except papermill.PapermillExecutionError as error:
        cell, line = _where(notebook, error.source)
        raise NotebookFailed(
            f"notebook {notebook.stem}, code cell {cell} ({line!r}): {error.ename}: {error.evalue} (see {executed})",
            EXIT_CODES.get(error.ename, 1),
        ) from error
    except (RuntimeError, KeyError) as error:  # nbclient's dead kernel, jupyter_client's missing one
        raise NotebookFailed(f"notebook {notebook.stem}: {type(error).__name__}: {error}") from error


def parameters_of(notebook: Path) -> dict[str, Any]:
    """The parameters of a notebook's tagged cell with their default values."""
    import papermill

    try:
        found = papermill.inspect_notebook(str(notebook))
    except Exception as error:  # nbformat raises many kinds of errors for a file that is not a notebook
        raise InvalidInput(f"{notebook} cannot be read as a notebook ({type(error).__name__})") from error
    return {name: ast.literal_eval(parameter["default"]) for name, parameter in found.items()}


def parameter_value(name: str, text: str, default: Any) -> Any:
    """The value of a parameter from its text, with the type of its default.

    Raises:
        InvalidInput: the text has another type, or is not a finite number.
    """
    if isinstance(default, str):
        return text
    try:
        value = ast.literal_eval({"true": "True", "false": "False"}.get(text, text))
    except (ValueError, SyntaxError):
        value = text
    if isinstance(default, float) and type(value) is int:
        value = float(value)
    if type(value) is not type(default) or (isinstance(value, float) and not math.isfinite(value)):
        kind = {bool: "true or false", int: "a whole number", float: "a finite number"}
        wanted = kind.get(type(default), f"a {type(default).__name__}")
        raise InvalidInput(f"parameter {name} = {text!r} must be {wanted}, such as {default!r}")
    return value


def _own_values(notebooks: list[Path], parameters: dict[str, str]) -> dict[Path, dict[str, Any]]:
    """For each notebook the parameters that it has. Refuse a parameter that no notebook has."""
    known = {notebook: parameters_of(notebook) for notebook in notebooks}
    names = sorted({name for defaults in known.values() for name in defaults} - {OUTPUT})
    for name in parameters:
        if name not in names:
            where = notebooks[0].stem if len(notebooks) == 1 else "the notebooks"
            raise InvalidInput(f"unknown parameter {name!r}: {where} know{'s' * (len(notebooks) == 1)} "
                               f"{', '.join(names) or 'none'}")  # fmt: skip
    return {
        notebook: {
            name: parameter_value(name, text, defaults[name]) for name, text in parameters.items() if name in defaults
        }
        for notebook, defaults in known.items()
    }


def _where(notebook: Path, source: str) -> tuple[int, str]:
    """The number of a code cell, counted from 1, and its first line of code."""
    import nbformat

    cells = [cell.source for cell in nbformat.read(notebook, as_version=4).cells if cell.cell_type == "code"]
    lines = [line for line in source.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    return (cells.index(source) + 1 if source in cells else 0), (lines or [""])[0]


def _move(staging: Path, place: Path) -> list[Path]:
    """Move files into their folder, each one completely or not at all."""
    place.mkdir(parents=True, exist_ok=True)
    moved = [place / file.name for file in sorted(staging.iterdir())]
    for target in moved:
        os.replace(staging / target.name, target)
    staging.rmdir()
    return moved
