"""What ties rigid bodies of lines together: the bodies, the evidence for the ratios of their scales, their places."""
