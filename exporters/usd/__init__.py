"""OpenUSD: the stage and its materials."""
