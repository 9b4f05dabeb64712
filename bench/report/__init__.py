"""Reports of a run: a Markdown table, and a page with plots that needs nothing beside itself. Both are made from the run's JSON alone."""
