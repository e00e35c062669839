"""Command line: options, the one-line parser, tables on the console."""
