"""From X-ray frames to polymer fractions, and back: tracks, attenuation, detectors, methods, results, simulated frames."""
