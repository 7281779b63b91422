"""`python -m linecad`: the command line."""

import sys

from linecad.cli.main import main

sys.exit(main())
