"""From text to the meta-model: what a front end is, the mapping language, the search path."""
