"""Bottle schemas drafted from captured messages."""
