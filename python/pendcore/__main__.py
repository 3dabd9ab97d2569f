"""`python -m pendcore` is the command `pendcore`."""

from __future__ import annotations

import sys

from pendcore.cli import main

if __name__ == "__main__":
    sys.exit(main())
