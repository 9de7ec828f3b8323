"""Error against cost of every rung on the bundled scenes: the table of docs/howto/trade-of-the-scenes.md.

python benchmarks/trade_scenes.py docs/howto/trade-of-the-scenes.md [SCENE ...]

Written after every scene; with names of scenes only those are measured, and the others' sections stay.
"""

import sys
import time
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


def sections(file):
    """Text of each scene in a page written before."""
    parts = file.read_text(encoding="utf-8").split("\n## `") if file.exists() else []
    return {part.split("`", 1)[0]: part.split("\n\n", 1)[1].strip() for part in parts[1:]}


def main():
    """Measure and write."""
    file, wanted = Path(sys.argv[1]), sys.argv[2:] or list(bundled_scenes())
    kept = {name: text for name, text in sections(file).items() if name in bundled_scenes()}
    for name in wanted:
        start = time.process_time()
        try:
            kept[name] = table(trade(load_scene(name)))
        except InputError as error:
            kept[name] = f"Not measured: {error}"
        print(f"{name}: {time.process_time() - start:.1f} s", flush=True)
        pages = [f"## `{scene}`\n\n{kept[scene]}\n" for scene in bundled_scenes() if scene in kept]
        file.write_text("\n".join([HEAD, *pages]), encoding="utf-8")


if __name__ == "__main__":
    main()
