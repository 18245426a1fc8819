"""python -m stepover: the command line."""

import sys


def run() -> None:
    """Run it. If a required module is missing, say in one line how to install it."""
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
