"""Version of the package; every result and store carries it."""

__version__ = "0.1.0"
