"""Below everything: errors, checks, units, files, lazy names. Knows no physics."""
