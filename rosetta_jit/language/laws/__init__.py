"""What a mapping guarantees of values that go there and come back."""
