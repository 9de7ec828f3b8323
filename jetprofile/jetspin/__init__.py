"""JETSPIN output files."""
