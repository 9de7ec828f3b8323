"""The rungs of the ladder: what moves the network, and what that makes of it."""
