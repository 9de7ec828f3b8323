"""The jet as it dries: places along it, and across it."""
