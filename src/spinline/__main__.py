"""``python -m spinline`` is the command line."""

from spinline.cli import main

main()
