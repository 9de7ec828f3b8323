"""Error against cost of every rung on the bundled scenes: the table of docs/howto/trade-of-the-scenes.md.

python benchmarks/trade_scenes.py docs/howto/trade-of-the-scenes.md
"""

import sys
from pathlib import Path

from spinline.base.errors import InputError
from spinline.scene import bundled_scenes, load_scene
from spinline.study.trade import trade

HEAD = """# The trade on the bundled scenes

Written by `python benchmarks/trade_scenes.py docs/howto/trade-of-the-scenes.md`: `spinline trade` on every bundled scene.
Errors are the largest of the reported quantities against the finest rung of each branch, times those of the processor, on one
core of a shared machine. The walk's error is that of sampling.
"""


def table(measured):
    """Markdown of one scene."""
    branches = list(measured.rungs[0].errors)
    lines = [
        "| model | setting | time | " + "".join(f"{branch} | " for branch in branches),
        "|---" * (3 + len(branches)) + "|",
    ]
    for rung in measured.rungs:
        if rung.refused:
            lines.append(
                f"| {rung.model} | {rung.setting} | refused: {rung.refused.splitlines()[0]} |" + " |" * len(branches)
            )
            continue
        errors = "".join(f"{rung.errors[branch]:.2g} | " for branch in branches)
        lines.append(f"| {rung.model} | {rung.setting} | {1e3 * rung.seconds:.3g} ms | {errors}")
    said = "; ".join(f"{branch}: {words}" for branch, words in measured.references.items())
    rows = "\n".join(line.rstrip() for line in lines)
    return f"{rows}\n\nReferences: {said}.\n\nRecommended at `rtol` = {measured.rtol:g}: {measured.recommendation}"


def main():
    """Measure and write."""
    parts = [HEAD]
    for name in bundled_scenes():
        print(name, flush=True)
        try:
            text = table(trade(load_scene(name)))
        except InputError as error:
            text = f"Not measured: {error}"
        parts.append(f"## `{name}`\n\n{text}\n")
    Path(sys.argv[1]).write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
