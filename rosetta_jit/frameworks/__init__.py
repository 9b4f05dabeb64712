"""What each framework knows: its IDL, its encodings, the manners of its holders."""
