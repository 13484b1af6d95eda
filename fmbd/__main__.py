"""`python -m fmbd` is the command `fmbd`."""

import sys

from fmbd.cli import main

sys.exit(main())
