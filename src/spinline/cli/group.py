"""The group of all commands."""

from typing import Any

from typer.core import TyperGroup

from spinline.base.errors import InputError

__all__ = ["Commands"]


class Commands(TyperGroup):
    """As typer's, but for its word for an end of file."""

    def invoke(self, ctx: Any) -> Any:
        """Run a command; typer takes an end of file for a question that nobody answers, and there are no questions."""
        try:
            return super().invoke(ctx)
        except EOFError as cut:
            if "marshal" not in str(cut):
                raise RuntimeError(f"a file ends too early: {cut}") from cut
            raise InputError(
                "Python's byte code",
                "is cut off, as a full disk leaves it",
                remedy="remove the folders __pycache__ where spinline is installed",
            ) from None
