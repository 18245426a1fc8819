"""python -m stepover: the command line."""

from stepover.cli import main

if __name__ == "__main__":
    main()
