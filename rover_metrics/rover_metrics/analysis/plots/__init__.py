"""Figures of a study, for screen and print: Okabe-Ito colours, line styles, units, thresholds."""
