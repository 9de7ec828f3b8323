"""Pictures of the documents, made by the very commands that the pages show.

    python benchmarks/docs_pictures.py            # all, into docs/images
    python benchmarks/docs_pictures.py window     # one

A picture stands below the command that makes it: the last ``$ spinline`` line above it in its page.
"""

import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).parents[1]
# picture: the page that shows it, and the file that the command writes
PICTURES = {
    "window": ("docs/howto/window.md", "peo5-water-window.png"),
    "peo5-water": ("README.md", "peo5-water.png"),
}


def command_of(name):
    """The command above a picture, as words."""
    page = (ROOT / PICTURES[name][0]).read_text(encoding="utf-8")
    if name == "peo5-water":
        return ["run", "peo5-water"]  # README: the first command of all
    before = page[: page.index(f"images/{name}.png")]
    return shlex.split(re.findall(r"^\$ spinline (.*)$", before, re.MULTILINE)[-1])


def make(name, folder):
    """Run the command in a folder; the picture it wrote."""
    program = [sys.executable, "-m", "spinline", *command_of(name)]
    subprocess.run(program, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return Path(folder) / PICTURES[name][1]


if __name__ == "__main__":
    for wanted in sys.argv[1:] or PICTURES:
        with tempfile.TemporaryDirectory() as scratch, Image.open(make(wanted, scratch)) as picture:
            few = picture.convert("RGB").quantize(256)  # colours enough, and a third of the size
            few.save(ROOT / "docs" / "images" / f"{wanted}.png", optimize=True)
        print(f"docs/images/{wanted}.png")
