"""Mutation testing: `make mutants` changes the code in small ways and asks which tests notice.

The mutations are mostly mutmut's. Its runner is not used: it rewrites each function behind a trampoline,
which leaves out decorated functions, properties and constants and which numba cannot compile.
"""
