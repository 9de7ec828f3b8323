"""Constants of this folder, SI."""

__all__ = ["EPS0", "GRAVITY"]

EPS0 = 8.8541878188e-12  # F/m, CODATA 2022
GRAVITY = 9.81  # m/s2
