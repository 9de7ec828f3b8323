"""Constitutive laws of the strands, one file each, their parameters as data: scene keys, checks and docs derive from them.

`LAWS` names them once. A new law is one file that ends in ``LAW = ConstitutiveLaw(...)`` and its line here; from outside the
package, `spinline.scene.register_law`.
"""

from spinline.rheology.constitutive import fenep, giesekus, maxwell, oldroyd
from spinline.rheology.constitutive.law import ConstitutiveLaw, LawParameter, Surroundings

__all__ = ["LAWS", "ConstitutiveLaw", "LawParameter", "Surroundings"]

LAWS: dict[str, ConstitutiveLaw] = {law.name: law for law in (maxwell.LAW, oldroyd.LAW, giesekus.LAW, fenep.LAW)}
