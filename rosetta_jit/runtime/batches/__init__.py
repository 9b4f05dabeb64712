"""Many messages at once: `filling` a `batch` from them, its `columns`, its `tables`, and its `parts`."""
