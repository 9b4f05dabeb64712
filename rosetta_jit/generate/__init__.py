"""Programs as source in other languages: what is proven here runs where there is no Python."""
