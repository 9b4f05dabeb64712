"""Transports: raw messages from and to middlewares, with the channel, the type's name and the times that each of them tells.

A transport gives and takes bytes. What they mean is the business of decoders and encoders, of which no transport knows.
"""
