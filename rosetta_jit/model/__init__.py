"""The meta-model: types, expressions, mappings, and where values lie in a holder."""
