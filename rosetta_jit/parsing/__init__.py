"""From text to trees: what every front end shares, and where files are searched for."""
