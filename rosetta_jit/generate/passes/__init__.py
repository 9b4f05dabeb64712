"""What is found in kernels, and made of them, before a language prints them."""
