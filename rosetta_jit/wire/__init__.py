"""The wire: codecs, which describe bytes without a direction."""
