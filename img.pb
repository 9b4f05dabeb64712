
abcdef