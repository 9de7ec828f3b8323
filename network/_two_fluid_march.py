"""Meshes and errors of the two-fluid network: from a first mesh to a solution whose error is known."""

from copy import copy
from dataclasses import dataclass, replace

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.network._two_fluid_box import Box, halved, on_parabolas, refined, remeshed, split, start_of, thinned

__all__ = ["March", "Solved"]

_CELLS = 200  # to begin with
_MOST_CELLS = 30_000
_ROUNDS = 3  # of moving the mesh
_GROWTH = 1.4  # of cells away from a layer
_GRADED = 8  # breaks that get a graded mesh of their own
_MOST_COARSE = 4000  # cells of a mesh that is only being moved
_MOST_RAMPED = 200
_SOFTER = (10.0, 1e2, 1e3, 1e4, 1e5, 1e6)  # couplings to come from


@dataclass(frozen=True, eq=False)
class Solved:
    """Nodes (n,), T and q at nodes and middles (2 n - 1, 2), and the estimated relative error of lam and w."""

    nodes: FloatArray
    state: FloatArray
    error: float = np.inf

    def on(self, nodes: FloatArray) -> FloatArray:
        """A guess on other nodes."""
        here, there = refined(self.nodes), refined(nodes)
        return np.stack([np.interp(there, here, column) for column in self.state.T], axis=1)


class March:
    """Solves one box between the nozzle and `begin`, for any tension there; stations and breaks become nodes."""

    def __init__(
        self, box: Box, begin: float, stations: FloatArray, breaks: FloatArray, rtol: float, spring: float = 1.0
    ) -> None:
        self.box, self.begin, self.stations, self.rtol, self.spring = box, begin, np.unique(stations), rtol, spring
        self.breaks = np.unique(np.concatenate(([0.0], breaks, [begin])))
        self.cells = max(_CELLS, 6 * self.breaks.size)
        self.keep = np.unique(np.concatenate((self.breaks, self.stations)))
        mesh = self._first_mesh()
        self.guess = Solved(mesh, start_of(box, mesh))

    def _first_mesh(self) -> FloatArray:
        """Even cells, and cells that grow away from every break, from a tenth of the layer that it may have."""
        parts = [np.linspace(0.0, self.begin, _CELLS + 1)]
        places = self.breaks if self.breaks.size <= _GRADED else self.breaks[[0, -1]]
        ends = self.box.eps(places) / np.maximum(self.box.profile(places), 1.0)
        layer = np.minimum(ends, self.box.relaxation(places))
        for place, width in zip(places, layer, strict=True):
            finest = min(max(0.1 * float(width), 1e-13 * self.begin), 0.01 * self.begin)
            steps = finest * _GROWTH ** np.arange(0.0, np.log(self.begin / finest) / np.log(_GROWTH))
            parts += [place + steps, place - steps]
        nodes = np.concatenate(parts)
        return thinned(nodes[(nodes >= 0) & (nodes <= self.begin)], self.breaks)

    def solve(self, end: float, start: Solved | None = None) -> Solved:
        """Solution with the tension `end` where the march begins; with a `start`, on its mesh, of no known error.

        Raises
        ------
        InputError
            Where Newton's method fails, or the error stays above `rtol`.
        """
        if start is not None:  # how far it is from the first is all that is asked of it: the first one's mesh
            return self._solved(thinned(np.union1d(self.guess.nodes, start.nodes), self.keep), start, end)
        now = self._solved(self.guess.nodes, self.guess, end)
        for _ in range(_ROUNDS):
            nodes = remeshed(now.nodes, self._curves(now), self.cells, self.breaks)
            state = self.box.solve(nodes, now.on(nodes), end)
            if state is None:  # the mesh that has an answer serves: halving it says how far off it is
                break
            now = Solved(nodes, state)
        now, before = self._solved(thinned(now.nodes, self.keep), now, end), np.inf
        while True:
            finer = self._solved(halved(now.nodes), now, end)
            errors = self._errors(now, finer)
            error = float(errors.max())
            if error <= self.rtol or finer.nodes.size > _MOST_CELLS:
                break
            if 0.5 * before < error < 2 * before:  # not made where it is seen: what a front moves by comes from afar
                now, before = finer, np.inf
            else:
                times = np.log(np.maximum(errors / self.rtol, 1e-300)) / np.log(8)  # of third order
                now, before = self._solved(split(now.nodes, times), finer, end), error
        if error > self.rtol:
            raise InputError(
                "rtol",
                f"is not reached: the two-fluid network is known to {error:.2g}",
                value=self.rtol,
                remedy="is the jet smooth between its breaks? name its kinks, or loosen rtol",
            )
        return replace(finer, error=error)

    def _errors(self, now: Solved, finer: Solved) -> FloatArray:
        """Estimated relative error of lam and w in each cell, from a finer mesh: at its ends, its middle and its quarters."""
        share = np.linspace(0.0, 1.0, 5)[:, np.newaxis]
        x = (1 - share) * now.nodes[:-1] + share * now.nodes[1:]
        here, there = (self._logarithms(on_parabolas(one.nodes, one.state, x)) for one in (now, finer))
        off = np.abs(here - there).max(axis=-1)
        whole = np.diff(np.searchsorted(finer.nodes, now.nodes)) == 1  # cells that rounding would not let halve
        off[1:-1, whole] = 0.0
        worst: FloatArray = off.max(axis=0)
        worst[np.isnan(worst)] = np.inf
        return worst / 7

    def _logarithms(self, state: FloatArray) -> FloatArray:
        """Ln lam and ln w; NaN where the parabola of a box is not positive."""
        t, q = np.moveaxis(state, -1, 0)
        lam = self.box.law.stretch(t)
        log_lam = np.log(np.where(lam > 0, lam, np.nan))
        return np.stack((log_lam, log_lam - q), axis=-1)

    def _curves(self, solved: Solved) -> list[FloatArray]:
        t, q = solved.state[::2].T
        log_lam = np.log(np.maximum(self.box.law.stretch(t), 1e-300))  # of a trial, to place nodes by
        return [t if self.box.law.bounded else log_lam, q, log_lam - q]

    def _solved(self, nodes: FloatArray, guess: Solved, end: float) -> Solved:
        state = self.box.solve(nodes, guess.on(nodes), end)
        if state is None:
            rough = self._roughly(Solved(nodes, guess.on(nodes)), end)
            if rough is not None:
                state = self.box.solve(nodes, rough.on(nodes), end)
            if rough is not None and state is None:  # too coarse a mesh for the third order
                self.cells = min(2 * self.cells, _MOST_COARSE)
                nodes = thinned(np.union1d(nodes, rough.nodes), nodes)
                state = self.box.solve(nodes, rough.on(nodes), end)
        if state is None:
            over = np.flatnonzero(self.box.profile(nodes) > self.box.law.full_stretch)
            raise InputError(
                "coupling",
                "no steady two-fluid network is found (Newton's method fails)",
                value=float(self.spring / self.box.eps(nodes[-1:])[0]),
                remedy="raise alpha_v or shorten the jet"
                if not over.size
                else f"shorten the jet: from s = {nodes[over[0]]:.3g} on it outruns the contour of strands that hardly relax",
            )
        return Solved(nodes, state)

    def _roughly(self, guess: Solved, end: float) -> Solved | None:
        """Solution of the scheme of first order, its mesh moved, then that of third order on the last mesh."""
        for first in (self._plain, self._ramped, self._softened):
            now = first(guess, end)
            found = None if now is None else self._sharpened(now, end)
            if found is not None:
                return found
        return None

    def _sharpened(self, now: Solved, end: float) -> Solved | None:
        """From the scheme of first order to that of third, the mesh following."""
        for _ in range(2 * _ROUNDS):
            nodes = remeshed(now.nodes, self._curves(now), 2 * self.cells, self.breaks)
            state = self.box.solve(nodes, now.on(nodes), end)
            if state is not None:
                return Solved(nodes, state)
            state = self.box.solve(nodes, now.on(nodes), end, plain=True)
            if state is None:
                return None
            now = Solved(nodes, state)
        return None

    def _plain(self, guess: Solved, end: float) -> Solved | None:
        """The scheme of first order."""
        state = self.box.solve(guess.nodes, guess.state, end, plain=True)
        return None if state is None else Solved(guess.nodes, state)

    def _softened(self, guess: Solved, end: float) -> Solved | None:
        """From a coupling that gives way to the one wanted: what strands at their contour bear grows as it gets stiffer."""
        box, softer = self.box, copy(self)
        for soft in _SOFTER:
            softer.box = self._trial(np.array([soft, 1.0]))
            now = softer._plain(guess, end) or softer._ramped(guess, end)
            if now is not None:
                break
        else:
            return None
        factor, contour = 10.0, box.law.full_stretch
        for _ in range(_MOST_RAMPED):
            if soft == 1:
                return now
            ahead = max(soft / factor, 1.0)
            softer.box = self._trial(np.array([ahead, 1.0]))
            mesh = remeshed(now.nodes, self._curves(now), self.cells, self.breaks)
            start = now.on(mesh)
            if box.law.bounded:
                start[:, 0] *= np.where(box.law.stretch(start[:, 0]) > 0.9 * contour, soft / ahead, 1.0)
            state = softer.box.solve(mesh, start, end, plain=True)
            if state is None:
                factor = factor**0.5
                if factor < 1.02:
                    return None
            else:
                now, soft, factor = Solved(mesh, state), ahead, min(factor**1.5, 30.0)
        return None

    def _ramped(self, guess: Solved, end: float) -> Solved | None:
        """From strands that relax fast in a network that slips little to these, in steps of both times, the mesh following."""
        box, nodes = self.box, guess.nodes
        v, th, eps = box.profile(nodes), box.relaxation(nodes), box.eps(nodes)
        if np.isinf(th).any():
            return None
        steepest = float(np.max(np.abs(np.diff(v)) / np.diff(nodes))) + 1e-300
        shares = np.minimum(1.0, [1e-3 / steepest / float(np.max(eps)), 0.3 / steepest / float(np.min(th))])
        trial = self._trial(shares)
        state = trial.solve(nodes, start_of(trial, nodes), end, plain=True)
        now, factor = (None if state is None else Solved(nodes, state)), 10.0
        for _ in range(_MOST_RAMPED):
            if now is None or (shares == 1).all():
                return now
            ahead = np.minimum(shares * ([factor, 1.0] if shares[0] < 1 else [1.0, factor]), 1.0)
            mesh = remeshed(now.nodes, self._curves(now), self.cells, self.breaks)
            state = self._trial(ahead).solve(mesh, now.on(mesh), end, plain=True)
            if state is None:
                factor = factor**0.5
                if factor < 1.02:
                    return None
            else:
                now, shares, factor = Solved(mesh, state), ahead, min(factor**1.5, 100.0)
        return None

    def _trial(self, shares: FloatArray) -> Box:
        eps, th = self.box.eps, self.box.relaxation
        a, b = shares.tolist()
        return replace(self.box, eps=lambda x: a * eps(x), relaxation=lambda x: b * th(x))
