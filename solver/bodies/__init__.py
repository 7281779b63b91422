"""The scene program: the scales of rigid bodies by the most evidence that can hold at once."""
