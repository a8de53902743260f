"""The tool chiaro: ``python -m chiaro``, and the console script."""

from __future__ import annotations

import os
import sys


def program() -> str:
    """Where the tool lies."""
    return os.path.join(os.path.dirname(os.path.abspath(__file__)), "_native", "chiaro")


def main() -> None:
    path = program()
    try:
        os.execv(path, [path, *sys.argv[1:]])
    except OSError as error:
        sys.exit(f"chiaro: the tool is missing from the package: {path} ({error.strerror})")


if __name__ == "__main__":
    main()
