"""From a scene to physics objects: solution, jet, air, material."""
