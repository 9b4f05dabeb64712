"""The words of diagnostics: a function or a value for each mistake, a module for each subject. Frameworks have their own.

A function takes the place and the facts and returns a `Diagnostic`; whoever notices the mistake says no word of its own.
"""
