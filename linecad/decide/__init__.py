"""Which crossings are real and why: annotations, stability under resampling, rigid bodies, the final decision."""
