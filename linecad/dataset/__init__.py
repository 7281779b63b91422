"""Made scenes with exact ground truth: modelled, drawn by a renderer, measured by a rasteriser of our own."""
