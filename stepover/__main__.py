"""python -m stepover: the command line."""

import sys


def run() -> None:
    """Run it; under a Python that lacks our requirements say in one line which one has them."""
    try:
        from stepover.cli import main

        main()
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] == "stepover":
            raise
        sys.stderr.write(
            f"error: {sys.executable} has no module {error.name!r}; in a checkout run 'make env' once, "
            "then '. .venv/bin/activate' or .venv/bin/python -m stepover\n"
        )
        sys.exit(2)


if __name__ == "__main__":
    run()
