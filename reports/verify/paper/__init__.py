"""The claims of the paper, judged again from flights by the rules of ``docs/verdict.md``.

Two files of the repository are read beside the run: the limits of its aircraft and ``reports/paper/audit.csv``.
"""
