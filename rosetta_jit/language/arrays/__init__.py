"""Rules about whole arrays, and elements that are known by a key."""
