"""What the standards of the Object Management Group share: OMG IDL, and Common Data Representation."""
