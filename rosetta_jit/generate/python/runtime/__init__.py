"""What generated modules need besides what is printed: `support` takes the definitions that a module names from these files, as text."""
