"""What generated modules begin with, and what some have besides, as text: each file is printed from its first statement on."""
