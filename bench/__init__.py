"""How fast it is: every claim of the README, measured as a ratio to a peer within one run."""
