"""Force-extension laws of a strand: ``f = F b / (k_B T)`` against ``x = xi / xi_max``.

==========  ======================================================  ======================  ========================
law         force f(x)                                              x -> 0                  x -> 1
==========  ======================================================  ======================  ========================
"linear"    ``3 x`` (Gaussian strand, x unbounded)                  ``3 x``                 no bound
"lattice"   ``atanh x + asinh[2 cosh(f_0) x / sqrt(1 - x^2)]``      ``(1 + 2 cosh f_0) x``  ``ln[4 cosh f_0/(1-x)]``
"langevin"  inverse of ``coth f - 1/f`` (freely jointed)            ``3 x + 9 x^3/5``       ``1/(1 - x)``
"fene"      ``3 x / (1 - x^2)``                                     ``3 x + 3 x^3``         ``3/[2 (1 - x)]``
==========  ======================================================  ======================  ========================

"lattice" inverts the random walk of Eq. (36a) at the lateral force f_0 (`rest_force`; 3 phi in a theta solvent);
the other laws do not depend on it. All are odd in x. Beyond rest they part: at x = 0.9 the forces are 2.7,
4.5 (f_0 = 0), 10 and 14.2.

How they are evaluated (relative errors below 1e-14 against 50 digits, wherever the result does not underflow):

* Langevin: Gauss's continued fraction below f = 2, exponentials above. Its inverse: the series
  ``3x + 9x^3/5 + 297x^5/175`` below x = 1e-3, else Kroeger's rational start and two Halley steps, on 1 - x
  instead of x once f > 2.
* `deficit` never subtracts x from 1 at large f: ``(e^-f + 2 cosh f_0)/Z``, ``1/f - 2/(e^2f - 1)``,
  ``[3 + 9/(h + 2f)]/(3 + h)`` with ``h = sqrt(9 + 4 f^2)``. The lattice deficit underflows to 0 beyond f = 745.
* ``exp(-max(|f|, f_0))`` is factored out of every ratio of exponentials: forces up to 1e300.

About 0.02 us a point ("fene", "linear"), 0.1 us (the others); numba compiles on first use, then from its cache.

References
----------
Greenfeld et al., Phys. Rev. E 84, 041806 (2011), Eq. (36) of the review; Kuhn and Gruen, Kolloid-Z. 101, 248
(1942); Warner, Ind. Eng. Chem. Fundam. 11, 379 (1972); Kroeger, J. Non-Newton. Fluid Mech. 223, 77 (2015).
"""

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError

__all__ = ["LAW_CODES", "ForceLaw", "deficit", "extension", "force", "law_code", "stiffness"]

ForceLaw = Literal["linear", "lattice", "langevin", "fene"]

LAW_CODES: dict[str, int] = {"linear": 0, "lattice": 1, "langevin": 2, "fene": 3}
"""Integer code of each law in the compiled kernels (`_force_kernels`)."""

_LARGEST_FORCE = 1e300
_LARGEST_REST_FORCE = 700.0


_Map = Callable[[int, FloatArray, FloatArray, FloatArray], None]


def force(extension: ArrayLike, law: ForceLaw, rest_force: ArrayLike = 0.0) -> FloatArray:
    """Force that holds a strand at a given extension.

    Parameters
    ----------
    extension : array_like
        ``x = xi / xi_max``, in (-1, 1); any ``|x| <= 1e300`` for "linear".
    law : {"linear", "lattice", "langevin", "fene"}
        Force-extension law.
    rest_force : array_like, optional
        Lateral force f_0 of "lattice", in [0, 700]; the other laws do not depend on it.

    Returns
    -------
    ndarray
        ``f = F b / (k_B T)``, dimensionless, broadcast shape of the inputs.

    Raises
    ------
    InputError
        For values out of range or not finite, or an unknown law.

    Examples
    --------
    >>> [round(float(force(0.5, law)), 6) for law in ("linear", "lattice", "langevin", "fene")]
    [1.5, 1.535953, 1.796756, 2.0]
    """
    from spinline.network import _force_kernels as kernels

    code = law_code(law)
    return _apply(kernels.map_force, code, _checked_extension(extension, code), rest_force)


def extension(force: ArrayLike, law: ForceLaw, rest_force: ArrayLike = 0.0) -> FloatArray:
    """Extension that a force gives: the inverse of `force`.

    Parameters
    ----------
    force : array_like
        ``f = F b / (k_B T)``, ``|f| <= 1e300``.
    law, rest_force
        As for `force`.

    Returns
    -------
    ndarray
        x in [-1, 1] (1 only by rounding: see `deficit`), unbounded for "linear".

    Raises
    ------
    InputError
        As `force`.
    """
    from spinline.network import _force_kernels as kernels

    return _apply(kernels.map_extension, law_code(law), _checked_force(force), rest_force)


def deficit(force: ArrayLike, law: ForceLaw, rest_force: ArrayLike = 0.0) -> FloatArray:
    """What lacks to full extension, ``1 - x``, exact also where x rounds to 1.

    Parameters
    ----------
    force, law, rest_force
        As for `extension`.

    Returns
    -------
    ndarray
        ``1 - x`` in [0, 2]; negative for "linear" beyond f = 3.
    """
    from spinline.network import _force_kernels as kernels

    return _apply(kernels.map_deficit, law_code(law), _checked_force(force), rest_force)


def stiffness(extension: ArrayLike, law: ForceLaw, rest_force: ArrayLike = 0.0) -> FloatArray:
    """Stiffness ``df/dx`` of a strand at a given extension, > 0.

    Parameters
    ----------
    extension, law, rest_force
        As for `force`.

    Returns
    -------
    ndarray
        3 for "linear"; ``[1 + a/sqrt(1 - x^2 + a^2 x^2)]/(1 - x^2)`` with ``a = 2 cosh f_0`` for "lattice";
        ``1/L'(f)`` for "langevin"; ``3 (1 + x^2)/(1 - x^2)^2`` for "fene".
    """
    from spinline.network import _force_kernels as kernels

    code = law_code(law)
    return _apply(kernels.map_stiffness, code, _checked_extension(extension, code), rest_force)


def law_code(law: str) -> int:
    """Code of a law in the compiled kernels, or an InputError."""
    if not isinstance(law, str) or law not in LAW_CODES:
        raise InputError("force_law", "is not known", value=law, allowed='"linear", "lattice", "langevin", "fene"')
    return LAW_CODES[law]


def _checked_extension(extension: ArrayLike, code: int) -> FloatArray:
    if code == LAW_CODES["linear"]:
        return real("extension", extension, least=-_LARGEST_FORCE, most=_LARGEST_FORCE)
    remedy = 'a strand cannot pass its contour under this law; "linear" has no bound'
    return real("extension", extension, above=-1.0, below=1.0, remedy=remedy)


def _checked_force(force: ArrayLike) -> FloatArray:
    return real("force", force, least=-_LARGEST_FORCE, most=_LARGEST_FORCE)


def _apply(kernel: _Map, code: int, value: FloatArray, rest_force: ArrayLike) -> FloatArray:
    rest = real("rest_force", rest_force, least=0.0, most=_LARGEST_REST_FORCE)
    try:
        value, rest = np.broadcast_arrays(value, rest)
    except ValueError:
        shapes = f"shapes {value.shape} and {rest.shape}"
        raise InputError("rest_force", f"does not broadcast: {shapes}") from None
    out = np.empty(value.shape)
    kernel(code, np.array(value).reshape(-1), np.array(rest).reshape(-1), out.reshape(-1))
    return out
