"""Compiled rates of `disentanglement`."""

import numpy as np

from spinline.base.kernels import njit

__all__ = ["slopes"]


@njit(cache=True, error_model="numpy")
def slopes(at, y, time, rates, log_slow, log_fast, per_segment, beta, loss):  # type: ignore[no-untyped-def]
    """Rates of ln A_zz, ln A_rr and ln nu; `log_slow` and `log_fast` are -ln tau_d and -ln tau_R at the samples."""
    i = min(max(np.searchsorted(time, at, side="right") - 1, 0), time.size - 2)
    u = (at - time[i]) / (time[i + 1] - time[i])
    rate = rates[i, 0] + u * (rates[i, 1] + u * rates[i, 2])
    slow = np.exp(log_slow[i] + u * (log_slow[i + 1] - log_slow[i]))
    fast = np.exp(log_fast[i] + u * (log_fast[i + 1] - log_fast[i]))
    a, b, nu = np.exp(y[0]), np.exp(y[1]), np.exp(y[2])
    trace = a + 2 * b
    size = np.sqrt(trace / 3)
    room = 1 - trace * per_segment * nu
    stiff = (1 - 3 * per_segment * nu) / max(room, 1e-12)
    back = 2 * stiff * (1 - 1 / size) * fast
    free = slow + back * beta / size  # rate at which A - I goes
    out = np.empty(3)
    out[0] = 2 * rate + free * np.expm1(-y[0]) - back
    out[1] = -rate + free * np.expm1(-y[1]) - back
    # edot S - dln lam_c/dt: half of what tr A gives back
    given = 0.5 * (free * (trace - 3) / trace + back)
    out[2] = slow * np.expm1(-y[2]) - loss * max(given, 0.0)
    return out
