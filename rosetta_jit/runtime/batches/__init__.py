"""Many messages at once: `filling` a `batch` from them, its `columns`, and its `parts`."""
