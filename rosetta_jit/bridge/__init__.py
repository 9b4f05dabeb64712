"""Bridges that run: routes between channels of middlewares, described by a file."""
