"""Drafts of mappings: what two types suggest by names, types, units and structure, as a text that a person goes on with."""
