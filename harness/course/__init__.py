"""The Course: seven tracks of fifty seeds, a score that every machine reproduces, and its receipt.

    python -m harness.course run gap --track rocky --out results
    python -m harness.course verify results/gap.json

docs/course.md has the rules.
"""
