"""What a mapping means, for a person: its types side by side, its rules, what they lose and cost, and the operations that they use."""
