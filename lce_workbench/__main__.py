"""Start from the shell: ``python -m lce_workbench``. Signals end it in order even while the libraries are loading."""

import os
import signal
import sys
from types import FrameType


def _stop(_number: int, _frame: FrameType | None) -> None:
    os.write(2, b"lce: interrupted; nothing was changed\n")
    os._exit(130)


for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    signal.signal(number, _stop)

from lce_workbench.cli import main  # noqa: E402

sys.exit(main(sys.argv[1:]))
