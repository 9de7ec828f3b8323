"""The command ``spinline``, and ``python -m spinline``."""

import os


def main() -> None:
    """Run the command line; from here on Ctrl-C ends it with status 130 and without a traceback.

    While modules are imported it ends at once: nothing is under way yet, and an exception would be lost or reworded by the
    module that happens to be imported. `spinline.cli.signals` takes over.
    """
    try:
        import signal  # takes a moment itself

        signal.signal(signal.SIGINT, lambda *_: os._exit(130))
    except KeyboardInterrupt:
        os._exit(130)
    from spinline.cli.commands import main as command_line

    command_line()


if __name__ == "__main__":
    main()
