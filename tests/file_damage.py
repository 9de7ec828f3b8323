"""Damage for files, and a judge that survives what it reads: used by the attack tests and by ``benchmarks/attack.py``.

A victim is a file (or a folder of files) that the program writes or reads. It is damaged in one of five ways and read again
in a process of its own; the verdict is one word.

=============  =====================================================================================
``same``       the same numbers, bit for bit
``refused``    an `InputError`
``redone``     seen to be damaged, and made again (checkpoints, stores)
``read``       read, where the file is another program's and carries no checksum
``different``  other numbers without a word: must never be
``traceback``  any other exception: must never be
``crash``      the process died: must never be
``hang``       more than 20 s of processor time, or 300 s of waiting: must never be
=============  =====================================================================================
"""

import os
import random
import select
import shutil
import signal
import time
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

GOOD = {"same", "refused", "redone", "read"}
LONGEST = 20.0  # s of processor time
_WAITING = 300.0  # s that a process may wait for the processor
_BATCH = 25


@dataclass(frozen=True)
class Victim:
    """Something to damage: where it is, how it is read, and whether it carries checksums of ours."""

    name: str
    place: Path
    read: Callable[[Path], Any]
    ours: bool = True


def damage(data: bytes, rng: random.Random) -> bytes:
    """The bytes with one thing wrong: a bit, a byte, a cut, a hole, or a run of zeros."""
    if not data:
        return b"\x00"
    at = rng.randrange(len(data))
    kind = rng.choice(("bit", "bit", "byte", "cut", "hole", "zeros"))
    span = min(len(data) - at, rng.choice((1, 16, 512, 4096)))
    if kind == "bit":
        return data[:at] + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1 :]
    if kind == "byte":
        return data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]
    if kind == "cut":
        return data[:at]
    if kind == "hole":
        return data[:at] + data[at + span :]
    return data[:at] + bytes(span) + data[at + span :]


def damaged(victim: Victim, folder: Path, seed: int) -> Path:
    """A damaged copy of a victim; of a folder one file is damaged, or gone."""
    rng = random.Random(f"{victim.name} {seed}")
    copy = folder / f"{seed}-{victim.place.name}"
    if victim.place.is_dir():
        shutil.copytree(victim.place, copy)
        files = sorted(file for file in copy.rglob("*") if file.is_file())
        file = rng.choice(files)
        if rng.random() < 0.15:
            file.unlink()
            return copy
    else:
        shutil.copyfile(victim.place, copy)
        file = copy
    file.write_bytes(damage(file.read_bytes(), rng))
    return copy


def attack(victim: Victim, folder: Path, seeds: range) -> tuple[Counter[str], list[str]]:
    """Verdicts on so many damaged copies, and the worst in words."""
    whole = victim.read(victim.place)
    verdicts: Counter[str] = Counter()
    bad: list[str] = []
    todo = list(seeds)
    while todo:
        batch, todo = todo[:_BATCH], todo[_BATCH:]
        done, reason = _batch(victim, whole, folder, batch)
        for seed, verdict in done.items():
            verdicts[verdict.partition(":")[0]] += 1
            if verdict.partition(":")[0] not in GOOD:
                bad.append(f"{victim.name} {seed} {verdict}")
        if len(done) < len(batch):  # the next one ended the process
            verdicts[reason] += 1
            bad.append(f"{victim.name} {batch[len(done)]} {reason}")
            todo = batch[len(done) + 1 :] + todo
    return verdicts, bad


def _batch(victim: Victim, whole: Any, folder: Path, batch: list[int]) -> tuple[dict[int, str], str]:
    """Verdicts by a child, up to the damage that kills it or keeps it busy."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        for stream in (1, 2):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
        try:
            for seed in batch:
                os.write(writing, f"{seed} {_judge(victim, whole, folder, seed)}\n".encode())
        finally:
            os._exit(0)
    os.close(writing)
    text, reason, last, used = b"", "crash", time.monotonic(), 0.0
    while True:
        ready, _, _ = select.select([reading], [], [], LONGEST)
        more = os.read(reading, 65536) if ready else b""
        if not ready and _used(child) - used < LONGEST and time.monotonic() - last < _WAITING:
            continue  # it did not get the processor
        if not more:
            reason = "crash" if ready else "hang"
            break
        text, last, used = text + more, time.monotonic(), _used(child)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    os.close(reading)
    lines = [line.split(" ", 1) for line in text.decode().splitlines()]
    return {int(seed): verdict for seed, verdict in lines}, reason


def _used(process: int) -> float:
    """Processor time of a process so far, s; where the system does not say, that of the clock."""
    try:
        words = Path(f"/proc/{process}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    except OSError:
        return time.monotonic()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def _judge(victim: Victim, whole: Any, folder: Path, seed: int) -> str:
    from spinline.base.errors import InputError

    copy = damaged(victim, folder, seed)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = victim.read(copy)
    except InputError:
        return "refused"
    except Exception as error:
        return f"traceback: {type(error).__name__} {str(error).splitlines()[:1]}"
    finally:
        shutil.rmtree(copy, ignore_errors=True) if copy.is_dir() else copy.unlink(missing_ok=True)
    if isinstance(found, str) and found == "redone":
        return "redone"
    if same(found, whole):
        return "same"
    return "different" if victim.ours else "read"


def same(a: Any, b: Any) -> bool:
    """Bit for bit."""
    if isinstance(a, dict):
        return isinstance(b, dict) and a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    return type(a) is type(b) and a == b
