"""From a codec and a mapping to a kernel: resolve, check, lower, and the passes."""
