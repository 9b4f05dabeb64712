"""From text to trees: what every front end shares."""
