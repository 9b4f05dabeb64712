"""From what a user asks for to a program, stage by stage."""
