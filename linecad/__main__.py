"""`python -m linecad`: the command line."""

import sys

from linecad.cli import main

sys.exit(main())
