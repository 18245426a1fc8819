"""The command line, one module for each command: plan, simulate, view, study, sweep, reproduce.

Each command imports what it needs when it runs. So help and error messages appear at once.
"""

from __future__ import annotations

import click

from stepover import __version__
from stepover.cli.commands import Commands
from stepover.cli.plan import plan
from stepover.cli.reproduce import reproduce
from stepover.cli.simulate import simulate
from stepover.cli.study import study
from stepover.cli.sweep import sweep
from stepover.cli.view import view


@click.group(
    name="stepover", cls=Commands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110}
)
@click.version_option(__version__, prog_name="stepover")
def main() -> None:
    """Humanoid robots that walk dynamically over large obstacles, after Stasse et al., T-RO 2009.

    Lengths are in metres, times in seconds. Exit codes: 0 done, 2 bad input or no place to write, 3 the obstacle
    cannot be crossed, 4 the simulated robot fell or touched the obstacle, 130 interrupted.
    """


for command in (plan, simulate, view, study, sweep, reproduce):
    main.add_command(command)
