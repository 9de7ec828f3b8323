"""What solution, solvent and air do to a beam: attenuation, refraction, spectra."""
