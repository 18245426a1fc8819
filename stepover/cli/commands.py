"""What all commands share: one-line errors, exit codes, a progress bar.

Exit codes: 0 done; 2 bad input, or a file that cannot be written; 3 an obstacle that cannot be crossed; 4 the simulated
robot fell or touched the obstacle; 130 interrupted. An error is one line on stderr. With --json, stdout is exactly one
JSON object.
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NoReturn, TextIO

import click

from stepover.errors import Infeasible, InvalidInput, StepOverError
from stepover.extras import needs

DONE, BAD_INPUT, INFEASIBLE, NOT_CROSSED, INTERRUPTED = 0, 2, 3, 4, 130


class Commands(click.Group):
    """A group of commands whose errors are one line on stderr, with our exit codes."""

    def add_command(self, cmd: click.Command, name: str | None = None) -> None:
        """Add a command. If an optional library is missing, the error names the extra that installs it."""
        if cmd.callback is not None:
            cmd.callback = needs(str(cmd.name))(cmd.callback)
        super().add_command(cmd, name)

    def main(self, *args: Any, **options: Any) -> Any:
        """Run a command and leave with its exit code."""
        options["standalone_mode"] = False
        _open_streams()
        try:
            sys.exit(super().main(*args, **options) or DONE)
        except SystemExit as left:  # click leaves with 1 where the reader of a help page has gone
            raise SystemExit(DONE if left.code == 1 else left.code) from None
        except OSError as error:  # a help page on a full disk
            _drop(sys.stdout)
            complain(_unwritten(error), BAD_INPUT)
        except click.exceptions.NoArgsIsHelpError as error:
            click.echo(error.format_message(), err=True)
            sys.exit(BAD_INPUT)
        except click.Abort:
            complain("interrupted", INTERRUPTED)
        except click.ClickException as error:
            context = getattr(error, "ctx", None)
            hint = f"; see '{context.command_path} --help'" if context else ""
            complain(error.format_message().rstrip(".") + hint, BAD_INPUT)
        except StepOverError as error:
            complain(str(error), exit_code(error))


class Command(click.Command):
    """A command that accepts each option once, so that no value silently replaces another."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run it; what the operating system refuses, such as a full disk, is bad input."""
        try:
            return super().invoke(ctx)
        except OSError as error:
            raise InvalidInput(_unwritten(error)) from error

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Reject an option that is given twice, unless it may be repeated."""
        _, _, order = self.make_parser(ctx).parse_args(list(args))
        for option, times in Counter(order).items():
            if isinstance(option, click.Option) and times > 1 and not (option.multiple or option.is_eager):
                raise click.UsageError(f"{' / '.join([*option.opts, *option.secondary_opts])} is given twice", ctx)
        return super().parse_args(ctx, args)


def exit_code(error: StepOverError) -> int:
    """Exit code of an error: its own if it has one, 3 if the obstacle cannot be crossed, else 2."""
    return getattr(error, "exit_code", INFEASIBLE if isinstance(error, Infeasible) else BAD_INPUT)


def complain(message: str, code: int) -> NoReturn:
    """Print one line on stderr and leave."""
    try:
        click.echo(f"error: {' '.join(message.split())}", err=True)
    except OSError:  # nobody can be told
        _drop(sys.stderr)
    sys.exit(code)


def say(text: str) -> None:
    """Print on stdout; where its reader has gone, as with "| head", the rest is dropped and the work goes on.

    Raises:
        InvalidInput: stdout cannot be written to: the disk is full.
    """
    try:
        click.echo(text)
    except BrokenPipeError:
        _drop(sys.stdout)
    except OSError as error:
        _drop(sys.stdout)
        raise InvalidInput(f"standard output cannot be written: {error.strerror}") from error


def _unwritten(error: OSError) -> str:
    """What the operating system refused, in a few words."""
    return f"{error.filename or 'a file'} cannot be read or written: {error.strerror or error}"


def _open_streams() -> None:
    """Lead stdout and stderr to nowhere where they are closed: else the first file to be opened takes their place."""
    for name, descriptor in (("stdin", 0), ("stdout", 1), ("stderr", 2)):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(descriptor, "r" if descriptor == 0 else "w", closefd=False))


def _drop(stream: TextIO) -> None:
    """Lead a stream to nowhere, so that what is left in it does no harm when Python ends."""
    with contextlib.suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


@contextlib.contextmanager
def goes_on(output: Path) -> Iterator[None]:
    """If long work is interrupted, tell the user how to continue it."""
    try:
        yield
    except KeyboardInterrupt:
        complain(f"interrupted; finished work is kept beside {output}: run the same command to continue", INTERRUPTED)


@contextlib.contextmanager
def progress(what: str) -> Iterator[Callable[[float], None]]:
    """A progress bar on stderr, if that is a terminal. Call it with the share done; the first call shows the bar."""
    from tqdm import tqdm

    form = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}"
    bars: list[tqdm[NoReturn]] = []

    def show(share: float) -> None:
        if not bars:
            bars.append(tqdm(total=1.0, desc=what, disable=None, leave=False, bar_format=form))
        bars[0].n = share
        bars[0].refresh()

    try:
        yield show
    finally:
        for bar in bars:
            bar.close()


def one_thread_a_process() -> None:
    """Use one thread in each process, so that results do not depend on the number of jobs. Call before numpy loads."""
    for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(threads, "1")
