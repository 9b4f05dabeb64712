"""Rules for both directions → rules for each."""
