"""Settings of a recipe that no spinning line has: the chain answers, and says that nothing like it was ever spun."""

from spinline.recipe.believe import Recipe

__all__ = ["outside_remarks"]

_BREAKDOWN = 3e6  # V/m, of air
_RATES = (1e-14, 1e-7)  # m3/s: 0.04 uL/hour to 0.4 L/hour
_GAPS = (5e-3, 2.0)  # m
_MOST_POLYMER = 0.6


def outside_remarks(recipe: Recipe) -> tuple[str, ...]:
    """What of a recipe lies outside anything that is spun.

    Parameters
    ----------
    recipe : Recipe

    Returns
    -------
    tuple of str
    """
    said = []
    field = recipe.voltage / recipe.gap
    if field > _BREAKDOWN:
        said.append(f"{field / 1e5:.3g} kV/cm between needle and collector: air breaks down at 30")
    if not _RATES[0] <= recipe.flow_rate <= _RATES[1]:
        said.append(f"a flow of {recipe.flow_rate * 3.6e9:.3g} mL/hour is out of the usual 0.01 to 100: check its unit")
    if not _GAPS[0] <= recipe.gap <= _GAPS[1]:
        said.append(f"a gap of {100 * recipe.gap:.3g} cm is out of the usual 5 to 30: check its unit")
    if recipe.mass_fraction > _MOST_POLYMER:
        said.append(f"{100 * recipe.mass_fraction:.3g} wt% of polymer is no solution that flows through a needle")
    return tuple(said)
