"""The recipe that tests of recipes share: PAN 10 wt% in DMF, 15 kV over 15 cm, 1 mL/h."""

from spinline.recipe import Recipe

PAN = Recipe(
    polymer="PAN",
    solvent={"DMF": 1.0},
    voltage=15e3,
    gap=0.15,
    flow_rate=1e-6 / 3600,
    mass_fraction=0.10,
    usual_fraction=0.1,
)
