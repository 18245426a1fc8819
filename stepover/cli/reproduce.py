"""The command reproduce: every notebook, every figure, every claim."""

from __future__ import annotations

from collections import Counter

import click

from stepover.cli.commands import Command, say
from stepover.cli.options import pairs


@click.command(cls=Command)
@click.option("--only", metavar="NOTEBOOK", help="Run only this notebook, such as stepover_15cm.")
@click.option(
    "-p", "--parameter", "parameters", multiple=True, metavar="NAME=VALUE", callback=pairs,
    help="Change a parameter in every notebook that has it; may be repeated. Results then go to build/.",
)  # fmt: skip
def reproduce(only: str | None, parameters: dict[str, str]) -> None:
    """Run every notebook. Write figures and claims to figures/, and update their pages in docs/ and the README.

    All notebooks take about five minutes. Executed copies go to build/notebooks/. With -p, figures and records go to
    build/figures/ and the copies to build/experiment/. So an experiment never overwrites the reference. If a notebook
    rejects the parameters, the others still run, and the error at the end names it.

    Example: python -m stepover reproduce --only stepover_15cm -p height=0.1
    """
    from stepover.locations import checkout
    from stepover.reproduction.pages import tally
    from stepover.reproduction.run import reproduce as run_notebooks
    from stepover.reproduction.verdicts import read_entries

    top = checkout()
    written = run_notebooks(top, only, parameters)
    folders = Counter(f"{path.parent.relative_to(top)}/" for path in written if path.parent != top)
    made = [f"{count} file{'s' * (count > 1)} in {folder}" for folder, count in folders.items()]
    copies = "build/experiment/" if parameters else "build/notebooks/"
    say(f"written: {', '.join([*made, f'executed notebooks in {copies}'])}")
    if not parameters:
        say(tally(read_entries(top / "figures" / "claims.json")))
