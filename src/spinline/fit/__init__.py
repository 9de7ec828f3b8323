"""Parameters from measurements: observations, problems, least squares, posterior, diagnostics."""
