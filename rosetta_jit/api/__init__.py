"""What a user holds: decoders and encoders, and the options to make them with."""
