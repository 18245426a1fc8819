"""The command reproduce: every notebook, every figure, every claim."""

from __future__ import annotations

import click

from stepover.cli.options import pairs


@click.command()
@click.option("--only", metavar="NOTEBOOK", help="Run this notebook alone, such as stepover_15cm.")
@click.option(
    "-p", "--parameter", "parameters", multiple=True, metavar="NAME=VALUE", callback=pairs,
    help="Change a parameter of the notebooks; may be repeated. Results go to build/ then.",
)  # fmt: skip
def reproduce(only: str | None, parameters: dict[str, str]) -> None:
    """Run every notebook; write every figure and claim to figures/ and the claims to README's table.

    Executed copies go to build/notebooks/. With -p figures and records go to build/figures/, so that an experiment
    never overwrites the reference.

    Example: python -m stepover reproduce --only stepover_15cm -p height=0.1
    """
    from stepover.report.reproduce import checkout
    from stepover.report.reproduce import reproduce as run_notebooks

    for path in run_notebooks(checkout(), only, parameters):
        click.echo(path)
