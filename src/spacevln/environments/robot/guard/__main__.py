"""The wheel guard's process."""

import sys

from spacevln.environments.robot.guard.process import main

sys.exit(main())
