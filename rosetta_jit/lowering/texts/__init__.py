"""Texts while rules run: read, compared, searched, made."""
