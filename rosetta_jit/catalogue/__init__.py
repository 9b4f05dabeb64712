"""The words of every diagnostic, one function a mistake, one module a language.

A function takes the place and the facts and returns a `Diagnostic`; whoever notices the mistake says no word of its own.
"""
