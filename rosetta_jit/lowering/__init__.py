"""From a codec and the typed rules of a mapping to a kernel. `lower` is where it begins, `writer` what all of it writes to."""
