"""``python -m spinline`` is the command line."""

from spinline.cli.commands import main

main()
