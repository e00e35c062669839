"""The Course: seven tracks of fifty seeds, a score, and a receipt by which it is driven again.

    python -m harness.course run gap --track rocky --out results
    python -m harness.course verify results/gap.json

docs/course.md has the rules.
"""
