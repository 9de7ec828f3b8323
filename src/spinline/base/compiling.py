"""How numba's compiler is run here: the same code in half the time.

Measured on a run that compiles forty loops, numba spends its time on what the loops do not need. What is left out:

- comparing the compiler's settings, each a table of twenty, at every operation that is typed (`_SharedFlags`);
- looking up anew which of numba's rules an operation on numbers and arrays comes under (`_Remembering`);
- optimising each function before it is linked into its caller and optimised there (`_Library`);
- machine code of what is called only from other loops (`_PartLibrary`);
- counting references to arrays in loops that make none and give none away (`_Lower`);
- asking for the rules of sums and elements a second time, to write the few instructions that they are (`_Lower`).
"""

# mypy: allow-untyped-calls
# numba's inside has no types

import operator
from functools import partial
from types import CodeType
from typing import Any, ClassVar

import numpy as np
from numba.core import cgutils, codegen, compiler, ir, ir_utils, lowering, typed_passes, types, untyped_passes
from numba.core.compiler_machinery import register_pass
from numba.core.targetconfig import ConfigStack
from numba.core.typing.context import Context
from numba.np.arrayobj import fix_integer_index, load_item, store_item
from numba.np.ufunc.dufunc import DUFunc

__all__ = ["AS_PART", "AS_WHOLE"]


class _Library(codegen.JITCodeLibrary):
    """Machine code of a loop, optimised once, with all its parts."""

    def _optimize_functions(self, module: Any) -> None:
        module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        made = self._codegen._module_pass_manager(opt=2)
        if isinstance(made, tuple):
            passes, builder = made
            passes.run(self._final_module, builder)
        else:  # numba before 0.62
            super()._optimize_final_module()


class _PartLibrary(_Library):
    """Translated code that waits to be linked into its caller's."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    @property
    def codegen(self) -> Any:
        """Nothing: there is no machine code yet that would need its surroundings."""
        return _Nowhere


class _Nowhere:
    @staticmethod
    def set_env(name: str, environment: object) -> None:
        pass


class _SharedFlags(compiler.Flags):
    """What the functions within a loop are compiled by: one object for all loops alike."""

    __slots__ = ("_hash",)
    _hash: int

    def __init__(self, flags: Any) -> None:
        super().__init__(flags)
        self._hash = super().__hash__()

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> Any:
        return self is other or super().__eq__(other)

    def copy(self) -> Any:
        return compiler.Flags(self)


class _Flags(compiler.Flags):
    __slots__ = ()
    _known: ClassVar[dict[Any, _SharedFlags]] = {}

    def copy(self) -> Any:
        key = tuple(sorted((name, str(value)) for name, value in self._values.items() if name not in _OF_THE_WAY_IN))
        if key not in self._known:
            shared = compiler.Flags(self)
            for name in _OF_THE_WAY_IN:
                shared.discard(name)
            self._known[key] = _SharedFlags(shared)
        return self._known[key]


_OF_THE_WAY_IN = ("no_cpython_wrapper", "no_cfunc_wrapper", "no_compile")


class _Remembering(Context):
    """Numba's rules of types, which remember what an operation on numbers and arrays came to."""

    def resolve_function_type(self, func: Any, args: Any, kws: Any) -> Any:
        known = self._lookup_global(func) or func
        if kws or type(known) is not types.Function or not all(isinstance(a, _PLAIN) and a.is_precise() for a in args):
            return super().resolve_function_type(func, args, kws)
        key = id(known), tuple(args), id(ConfigStack.top_or_none())
        if key not in _FOUND:
            _FOUND[key] = super().resolve_function_type(func, args, kws), known
        return _FOUND[key][0]


_PLAIN = (types.Number, types.Boolean, types.Array, types.BaseTuple)
_FOUND: dict[Any, Any] = {}
_CONTEXTS: dict[Any, Any] = {}


def _remembering(typing: Any) -> Any:
    if typing not in _CONTEXTS:
        made = _CONTEXTS[typing] = _Remembering.__new__(_Remembering)
        made.__dict__ = typing.__dict__
    return _CONTEXTS[typing]


class _Lower(lowering.Lower):
    """Without reference counts where all arrays are the caller's, or views of them; elements and sums written directly."""

    def lower(self) -> None:
        counted = self.context.enable_nrt
        self.context.enable_nrt = counted and not _only_borrows(self)
        super().lower()
        self.context.enable_nrt = counted
        self.context.__dict__.pop("nrt", None)

    def delvar(self, name: str) -> None:
        if self.context.enable_nrt and self.context.data_model_manager[self.typeof(name)].contains_nrt_meminfo():
            super().delvar(name)
        elif name not in self._blk_local_varmap:  # used out of order
            self._singly_assigned_vars.discard(name)

    def lower_inst(self, inst: Any) -> Any:
        if isinstance(inst, ir.StaticSetItem) and self._element(inst.target, inst.index_var):
            return self.lower_setitem(inst.target, inst.index_var, inst.value, self.fndesc.calltypes[inst])
        return super().lower_inst(inst)

    def lower_expr(self, kind: Any, expr: Any) -> Any:
        if expr.op == "static_getitem" and self._element(expr.value, expr.index_var):
            return self.lower_getitem(kind, expr, expr.value, expr.index_var, self.fndesc.calltypes[expr])
        if expr.op == "getiter" and self._by_one(expr.value):
            return self._counter(kind, expr.value)
        return super().lower_expr(kind, expr)

    def lower_binop(self, kind: Any, expr: Any, op: Any) -> Any:
        sides, signature = (expr.lhs, expr.rhs), self.fndesc.calltypes[expr]
        write = _WRITTEN.get((op, *signature.args))
        plain = expr.static_lhs is ir.UNDEFINED and expr.static_rhs is ir.UNDEFINED
        if (
            write is None
            or not plain
            or (op is operator.truediv and self.context.error_model.raise_on_fp_zero_division)
        ):
            return super().lower_binop(kind, expr, op)
        given = [self._cast_var(side, into) for side, into in zip(sides, signature.args, strict=True)]
        return self.context.cast(self.builder, write(self.builder, *given), signature.return_type, kind)

    def lower_getitem(self, kind: Any, expr: Any, value: Any, index: Any, signature: Any) -> Any:
        if not self._element(value, index):
            return super().lower_getitem(kind, expr, value, index, signature)
        array = self.typeof(value.name)
        return self.context.cast(
            self.builder, load_item(self.context, self.builder, array, self._place(value, index)), array.dtype, kind
        )

    def lower_setitem(self, target: Any, index: Any, value: Any, signature: Any) -> Any:
        array = self.typeof(target.name)
        if not self._element(target, index) or not isinstance(self.typeof(value.name), _NUMBERS):
            return super().lower_setitem(target, index, value, signature)
        item = self._cast_var(value, array.dtype)
        return store_item(self.context, self.builder, array, item, self._place(target, index))

    def _by_one(self, value: Any) -> bool:
        """Whether a loop's counter is a range that goes up one by one."""
        made = ir_utils.guard(ir_utils.get_definition, self.func_ir, value)
        ranges = (
            isinstance(self.typeof(value.name), types.RangeType) and isinstance(made, ir.Expr) and made.op == "call"
        )
        return bool(ranges and made.vararg is None and len(made.args) < 3)

    def _counter(self, kind: Any, value: Any) -> Any:
        builder, proxy = self.builder, cgutils.create_struct_proxy
        given = proxy(self.typeof(value.name))(self.context, builder, value=self.loadvar(value.name))
        made, none, one = proxy(kind)(self.context, builder), given.start.type(0), given.start.type(1)
        ahead = builder.sub(given.stop, given.start)
        made.iter, made.stop, made.step = cgutils.alloca_once(builder, none.type), given.stop, one
        made.count = cgutils.alloca_once(builder, none.type)
        builder.store(given.start, made.iter)
        builder.store(builder.select(builder.icmp_signed(">", ahead, none), ahead, none), made.count)
        return made._getvalue()

    def _element(self, value: Any, index: Any) -> bool:
        """Whether an index is of one number in an array."""
        if index is None:
            return False
        array, by = self.typeof(value.name), _each(self.typeof(index.name))
        plain = (
            isinstance(array, types.Array) and isinstance(array.dtype, _NUMBERS) and not self.context.enable_boundscheck
        )
        return plain and len(by) == array.ndim and all(isinstance(k, types.Integer) for k in by)

    def _place(self, value: Any, index: Any) -> Any:
        builder, kind, by = self.builder, self.typeof(value.name), self.typeof(index.name)
        array, at = self.loadvar(value.name), self.loadvar(index.name)
        field = self.context.data_model_manager[kind].get_field_position
        shape = [builder.extract_value(array, [field("shape"), k]) for k in range(kind.ndim)]
        spaced = range(kind.ndim) if kind.layout == "A" else ()
        strides = [builder.extract_value(array, [field("strides"), k]) for k in spaced]
        every = [builder.extract_value(at, k) for k in range(kind.ndim)] if isinstance(by, types.BaseTuple) else [at]
        places = [
            fix_integer_index(self.context, builder, k, i, size)
            for k, i, size in zip(_each(by), every, shape, strict=True)
        ]
        data = builder.extract_value(array, field("data"))
        return cgutils.get_item_pointer2(self.context, builder, data, shape, strides, kind.layout, places)


def _each(kind: Any) -> tuple[Any, ...]:
    tuples: Any = types.BaseTuple
    return tuple(kind.types) if isinstance(kind, tuples) else (kind,)


def _written() -> dict[Any, Any]:
    real, whole = types.float64, types.int64
    made: dict[Any, Any] = {}
    for op, name in ((operator.add, "add"), (operator.sub, "sub"), (operator.mul, "mul"), (operator.truediv, "div")):
        made[op, real, real] = partial(_call, "f" + name)
        if name != "div":
            made[op, whole, whole] = partial(_call, name, flags=("nsw",))
    for op, sign in (
        (operator.lt, "<"),
        (operator.le, "<="),
        (operator.gt, ">"),
        (operator.ge, ">="),
        (operator.eq, "=="),
        (operator.ne, "!="),
    ):
        made[op, real, real] = partial(_compare, "fcmp_unordered" if sign == "!=" else "fcmp_ordered", sign)
        made[op, whole, whole] = partial(_compare, "icmp_signed", sign)
    return made


def _call(name: str, builder: Any, a: Any, b: Any, **options: Any) -> Any:
    return getattr(builder, name)(a, b, **options)


def _compare(name: str, sign: str, builder: Any, a: Any, b: Any) -> Any:
    return getattr(builder, name)(sign, a, b)


_NUMBERS = (types.Number, types.Boolean)
_WRITTEN = _written()


def _only_borrows(lower: Any) -> bool:
    models, kinds, calls = lower.context.data_model_manager, lower.fndesc.typemap, lower.fndesc.calltypes

    def counted(kind: Any) -> bool:
        return bool(models[kind].contains_nrt_meminfo())

    def free(*variables: Any) -> bool:
        return not any(counted(kinds[v.name]) for v in variables)

    def borrows(value: Any, into: Any) -> bool:
        if not isinstance(value, ir.Expr):
            return isinstance(value, ir.Var | ir.Arg | ir.Const | ir.Global | ir.FreeVar)
        if value.op == "call":
            given = value.list_vars()[1:] if isinstance(kinds[value.func.name], types.Dispatcher) else []
            return not counted(calls[value].return_type) and (bool(given) or free(*value.list_vars()))
        if value.op in ("getitem", "static_getitem"):
            index = value.index if value.op == "getitem" else value.index_var
            return free(into) or (isinstance(kinds[value.value.name], _HELD) and (index is None or free(index)))
        if value.op in ("getattr", "exhaust_iter"):
            return free(into) or isinstance(kinds[value.value.name], _HELD)
        return value.op in ("build_tuple", "cast") or free(into, *value.list_vars())

    if lower.generator_info is not None or counted(lower.fndesc.restype):
        return False
    for block in lower.blocks.values():
        for step in block.body:
            if isinstance(step, ir.Assign):
                if not borrows(step.value, step.target):
                    return False
            elif isinstance(step, ir.SetItem | ir.StaticSetItem):
                index = step.index if isinstance(step, ir.SetItem) else step.index_var
                if not free(step.value, *([] if index is None else [index])):
                    return False
            elif not isinstance(step, ir.Del | ir.Jump | ir.Branch | ir.Return | ir.StaticRaise):
                return False
    return True


_HELD = (types.Array, types.BaseTuple)


@register_pass(mutates_CFG=True, analysis_only=False)
class _Lowering(typed_passes.NativeLowering):
    _name = "spinline_lowering"

    @property
    def lowering_class(self) -> Any:
        return _Lower


@register_pass(mutates_CFG=True, analysis_only=False)
class _Inlining(untyped_passes.InlineClosureLikes):
    """Functions and comprehensions within a function: most have none."""

    _name = "spinline_inlining"

    def run_pass(self, state: Any) -> bool:
        code = state.func_id.code
        if not any(isinstance(c, CodeType) for c in code.co_consts) and not {"array", "reduce"} & {*code.co_names}:
            return False
        return bool(super().run_pass(state))


@register_pass(mutates_CFG=True, analysis_only=False)
class _Rewriting(typed_passes.NopythonRewrites):
    """Sums of whole arrays, and arrays of constants: most functions have none."""

    _name = "spinline_rewriting"

    def run_pass(self, state: Any) -> bool:
        if "array" not in state.func_id.code.co_names and all(
            _single(state, step.value, state.typemap[step.target.name])
            for block in state.func_ir.blocks.values()
            for step in block.find_insts(ir.Assign)
        ):
            return False
        return bool(super().run_pass(state))


def _single(state: Any, value: Any, into: Any) -> bool:
    if not isinstance(value, ir.Expr) or not isinstance(into, types.Array | types.Literal):
        return True
    if isinstance(into, types.Literal) or value.op in ("getitem", "static_getitem", "getattr", "cast", "exhaust_iter"):
        return not isinstance(into, types.StringLiteral)
    return value.op == "call" and not isinstance(
        getattr(state.typemap[value.func.name], "typing_key", None), _EVERYWHERE
    )


_EVERYWHERE = (np.ufunc, DUFunc)
_REPLACED = {
    typed_passes.NativeLowering: _Lowering,
    typed_passes.NopythonRewrites: _Rewriting,
    untyped_passes.InlineClosureLikes: _Inlining,
}


class _Compiler(compiler.Compiler):
    library: type[_Library] = _Library

    def __init__(self, typing: Any, target: Any, _: Any, a: Any, r: Any, flags: Any, *rest: Any) -> None:
        library: Any = self.library(target.codegen(), "loop")
        if self.library is _Library:
            library.enable_object_caching()
        super().__init__(_remembering(typing), target, library, a, r, _Flags(flags), *rest)

    def define_pipelines(self) -> Any:
        made: Any = super().define_pipelines()
        for passes in made:
            passes.passes = [(_REPLACED.get(p, p), why) for p, why in passes.passes]
            passes.finalize()
        return made


class _PartCompiler(_Compiler):
    library = _PartLibrary


AS_WHOLE = {"no_cfunc_wrapper": True, "pipeline_class": _Compiler}
AS_PART = {"no_cfunc_wrapper": True, "no_cpython_wrapper": True, "pipeline_class": _PartCompiler}
