# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""python -m limber3d: the program limber3d."""

import sys

from .command_line import main

sys.exit(main())
