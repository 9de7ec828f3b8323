"""What spinline says when an input cannot be right.

One exception for every refusal, so that a command can turn it into one message, and one warning class, so
that what is odd but possible can be filtered or collected.
"""

from typing import Any

from spinline.base.words import clean, one_line, shortened

__all__ = ["InputError", "SpinlineWarning"]


class InputError(ValueError):
    """An input that cannot be used: names the field, the value, what is allowed and the remedy.

    Parameters
    ----------
    field : str
        Name the user knows it by: a scene key ("jet.beta"), a file or an argument.
    problem : str
        What is wrong, in one clause.
    value : object, optional
        The offending value, shown with ``repr`` (shortened).
    allowed : str, optional
        The allowed range or set.
    remedy : str, optional
        What to do.
    """

    def __init__(self, field: str, problem: str, *, value: Any = None, allowed: str = "", remedy: str = "") -> None:
        self.field, self.problem, self.value = field, problem, value
        self.allowed, self.remedy = allowed, remedy
        shown = "" if value is None else f" = {_short(value)}"
        parts = [f"{shortened(one_line(field))}{shown}: {problem}"]
        if allowed:
            parts.append(f"allowed: {allowed}")
        if remedy:
            parts.append(remedy)
        # a word of ours is never that long: what is quoted in them is a key or a name from outside
        super().__init__(clean(" ".join(shortened(word) for word in "; ".join(parts).split(" "))))

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (self.field, self.problem, self.value, self.allowed, self.remedy)


def _rebuild(field: str, problem: str, value: Any, allowed: str, remedy: str) -> InputError:
    return InputError(field, problem, value=value, allowed=allowed, remedy=remedy)


class SpinlineWarning(UserWarning):
    """Something odd that does not stop the calculation; its text is also kept in the result."""


def _short(value: Any, limit: int = 60) -> str:
    text = value if isinstance(value, str) and value.startswith(("[", "array")) else repr(value)
    return text if len(text) <= limit else text[: limit - 3] + "..."
