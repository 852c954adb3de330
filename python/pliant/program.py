"""Runs the program `pliant` that is installed with this package."""

import os
import pathlib
import sys


def main():
    package = pathlib.Path(__file__).resolve().parent
    # In a wheel, and in a prefix.
    for program in (package / "bin" / "pliant", package.parents[3] / "bin" / "pliant"):
        if program.is_file():
            os.execv(program, [str(program), *sys.argv[1:]])
    sys.exit(f"pliant: there is no program in {package}; install Pliant again")
