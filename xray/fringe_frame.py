"""Whether a frame holds fringes: groups of its rows tested together, so that what no row shows alone is seen.

Each group of rows is summed where the jet stands still in it and tested as `fringes` does. Groups share the distance, so at each
one their projections add up, ``sum_g p_g . r_g / sqrt(sum_g p_g . p_g)``: the most powerful test of fringes of that distance in all of
them, 0 to 2 without any. Rows in which no jet is found are tested in groups of equal height with the fringes folded back first.

A profile that is not uniform, deep in many photons, may look like fringes of 1 mm to a fit of few shells. Absorption leaves one thing alone: the air
beside the jet, where no light can be over the beam's. So what is detected has to throw light there too: its pattern outside the jet's
edges, where it is strong enough to be seen, has to be found at a quarter of its strength at least.
"""
