"""Transfer of vapour and heat between a jet and the air: Sherwood and Nusselt numbers.

=======================  =============================================================================  =============
name                     law                                                                            range
=======================  =============================================================================  =============
``kase-matsuo``          ``0.495 Re^(1/3) [1 + (8 v_n/v)^2]^(1/6) Sc^(1/2)``, Re of v along the jet       0.5 < Re < 50
``churchill-bernstein``  ``0.3 + 0.62 Re^(1/2) Sc^(1/3) [1 + (0.4/Sc)^(2/3)]^(-1/4)                     Re Sc > 0.2
                         [1 + (Re/282000)^(5/8)]^(4/5)``, Re of the total speed
``yarin``                ``0.495 Re^(1/3) Sc^(1/2)``, Re of v along the jet: no cross-flow                0.5 < Re < 50
=======================  =============================================================================  =============

Pr takes the place of Sc for heat. ``Re = 2 r v/nu``; v and v_n are the speeds of the air past the jet, along it and
across it. Kase and Matsuo's is written ``0.495 (2 r/nu)^(1/3) (v^2 + 64 v_n^2)^(1/6) Sc^(1/2)``, which holds where v
is 0. Heat and vapour share one power of Re in it, so the wet bulb does not depend on Re. It goes to 0 with Re, where a
cylinder does not: `floor` sets a least number; Churchill and Bernstein's is for cylinders in cross-flow and
overestimates threads along their axis.

References
----------
Kase, Matsuo, J. Polym. Sci. A 3, 2541 (1965); Churchill, Bernstein, J. Heat Transfer 99, 300 (1977); Yarin,
Koombhongse, Reneker, J. Appl. Phys. 89, 3018 (2001).
"""

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, real
from spinline.base.errors import InputError

__all__ = ["LAWS", "RE_RANGE", "Transfer", "law_index", "transfer_number", "transfer_range"]

Transfer = Literal["kase-matsuo", "churchill-bernstein", "yarin"]
LAWS: tuple[str, ...] = get_args(Transfer)
_PREFACTOR, _CROSS = 0.495, 64.0
RE_RANGE = (0.5, 50.0)  # of the threads of Kase and Matsuo's measurements


def transfer_number(
    reynolds: ArrayLike,
    schmidt: ArrayLike,
    cross_flow: ArrayLike = 0.0,
    law: Transfer = "kase-matsuo",
    floor: float = 0.0,
) -> FloatArray:
    """Sherwood number (Nusselt's with Pr for Sc).

    Parameters
    ----------
    reynolds : array_like
        ``2 r v/nu`` of the speed along the jet, >= 0.
    schmidt : array_like
        Sc, or Pr, > 0.
    cross_flow : array_like
        ``2 r v_n/nu`` of the speed across it, >= 0.
    law : {"kase-matsuo", "churchill-bernstein", "yarin"}
    floor : float
        Least value, >= 0.

    Returns
    -------
    ndarray, broadcast shape.

    Examples
    --------
    >>> round(float(transfer_number(0.3, 0.6)), 3), round(float(transfer_number(0.3, 0.6, 0.3)), 3)
    (0.257, 0.515)
    >>> round(float(transfer_number(0.3, 0.6, law="churchill-bernstein")), 3)
    0.549
    """
    along, sc = real("reynolds", reynolds, least=0.0, most=1e100), real("schmidt", schmidt, above=0.0, most=1e100)
    across = real("cross_flow", cross_flow, least=0.0, most=1e100)
    least = number("sherwood_floor", floor, least=0.0)
    which = law_index(law)
    if which == 1:
        re = np.hypot(along, across)
        fall = (1 + (0.4 / sc) ** (2 / 3)) ** -0.25
        value = 0.3 + 0.62 * np.sqrt(re) * np.cbrt(sc) * fall * (1 + (re / 282000) ** 0.625) ** 0.8
    else:
        speed = along if which == 2 else np.hypot(along, np.sqrt(_CROSS) * across)
        value = _PREFACTOR * np.cbrt(speed) * np.sqrt(sc)
    return np.maximum(value, least)


def law_index(law: str) -> int:
    """Which of `LAWS`, for the compiled loops."""
    if not isinstance(law, str) or law not in LAWS:
        raise InputError("transfer", "is not known", value=law, allowed=", ".join(LAWS))
    return LAWS.index(law)


def transfer_range(law: str, reynolds: FloatArray, schmidt: float) -> str:
    """A sentence where Re leaves the range of a law; empty where it does not."""
    low, high = float(reynolds.min()), float(reynolds.max())
    if law == "churchill-bernstein":
        if low * schmidt < 0.2:
            return f"Re Sc is {low * schmidt:.3g} at the least, under the 0.2 of Churchill and Bernstein's correlation"
        return ""
    if low < RE_RANGE[0] or high > RE_RANGE[1]:
        return (
            f"Re is {low:.3g} to {high:.3g}, outside the {RE_RANGE[0]:g} to {RE_RANGE[1]:g} of the Sherwood correlation"
        )
    return ""
