"""How numba's compiler is run here: a loop with all the loops that it calls, optimised once.

numba optimises each function by itself, and again with all that it calls, and makes machine code of every one. Here a loop that
another one calls is translated only, and waits; what it ends in is optimised and made machine code as one piece. The numbers
are the same.
"""

from collections.abc import Iterable
from typing import Any, ClassVar

from numba.core.errors import NumbaError

__all__ = ["AS_PART", "AS_WHOLE", "CHANGED"]

# what an inside of numba raises that is another one by now
CHANGED = (AttributeError, TypeError, KeyError, NotImplementedError, ImportError, NumbaError)


def _settings(base: Any) -> Any:
    """Settings of a compiler whose copy, which numba keeps looking things up by, is one object for all loops alike."""

    class Settled(base):  # type: ignore[misc]
        """Settings that change no more: numba compares all thirty of them at every operation."""

        __slots__ = ("known",)
        same: ClassVar[dict[Any, Any]] = {}

        def __hash__(self) -> int:
            if not hasattr(self, "known"):
                self.known: int = super().__hash__()
            return self.known

        def __eq__(self, other: object) -> bool:
            return self is other or bool(super().__eq__(other))

        def copy(self) -> Any:
            return base(self)

    class Settings(base):  # type: ignore[misc]
        __slots__ = ()

        def copy(self) -> Any:
            made: Any = Settled(self)
            return Settled.same.setdefault(made, made)

    return Settings


def _options() -> tuple[dict[str, Any], dict[str, Any] | None]:
    """Options of a whole and of a part; None where this numba has no such parts."""
    options: dict[str, Any] = {"no_cfunc_wrapper": True}
    try:
        from numba.core import codegen, compiler

        settings = _settings(compiler.Flags)

        class Whole(codegen.JITCodeLibrary):
            def _optimize_functions(self, module: Any) -> None:
                """Only what the whole needs of it."""
                module.data_layout = self._codegen._data_layout

            def finalize(self) -> None:
                """With all parts of its parts, each once."""
                self._linking_libraries = [*_with_parts(self._linking_libraries)]
                super().finalize()  # type: ignore[no-untyped-call]

        class Part(Whole):
            """Translated code that waits to be linked, with its own parts, into the whole."""

            def finalize(self) -> None:
                self.parts, self._linking_libraries = self._linking_libraries, []
                super().finalize()

            def _optimize_final_module(self) -> None:
                pass

            def _finalize_final_module(self) -> None:
                self._finalize_dynamic_globals()  # type: ignore[no-untyped-call]
                self._finalized = True

            @property
            def codegen(self) -> Any:
                """Nothing: there is no machine code yet that would need its surroundings."""
                return _Nowhere

        class CompilesWhole(compiler.Compiler):
            library = Whole

            def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
                made = self.library(target.codegen(), "loop")  # type: ignore[no-untyped-call]
                made.enable_object_caching()  # type: ignore[no-untyped-call]
                given = [settings(r) if type(r) is compiler.Flags else r for r in rest]
                super().__init__(typing, target, made, *given)  # type: ignore[no-untyped-call]

        class CompilesPart(CompilesWhole):
            library = Part

        for name in {*vars(Whole), *vars(Part)} - {"__module__", "__doc__", "codegen"}:
            getattr(codegen.JITCodeLibrary, name)  # what would override nothing would do nothing
    except CHANGED:
        return options, None
    part = {**options, "no_cpython_wrapper": True, "pipeline_class": CompilesPart}
    return {**options, "pipeline_class": CompilesWhole}, part


def _with_parts(libraries: Iterable[Any]) -> dict[Any, None]:
    """All that is to be linked, in order, as the keys."""
    found: dict[Any, None] = {}
    waiting = [*libraries]
    for library in waiting:
        if library not in found:
            found[library] = None
            waiting += getattr(library, "parts", [])
    return found


class _Nowhere:
    @staticmethod
    def set_env(name: str, environment: object) -> None:
        pass


AS_WHOLE, AS_PART = _options()
