"""What a process that works for another does first."""

import os
import signal
import threading
import time
import warnings

from spinline.base.errors import SpinlineWarning

__all__ = ["start_worker"]


def start_worker(parent: int) -> None:
    """Leave Ctrl-C and warnings to the parent, and do not outlive it.

    Parameters
    ----------
    parent : int
        Its process number.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warnings.simplefilter("ignore", SpinlineWarning)

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(1.0)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
