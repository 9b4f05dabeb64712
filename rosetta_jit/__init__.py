"""Declare how robot middlewares' data types relate; decode one's bytes into the other's data holders at machine speed."""
