"""All rows of a jet at once: a smooth map of the fraction, by a penalised Poisson likelihood."""
