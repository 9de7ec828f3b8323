"""Fresnel fringes: their likelihood, their detection, phase retrieval."""
