"""Compute the results of a run again from its raw columns, and say where they differ: ``python reports/verify RUN_DIR``.

It shares no code with the testbed and needs numpy, scipy and pyarrow alone; a copy of this folder runs anywhere. It reads ``plan.json``,
``results.csv`` and ``columns/*.parquet`` of a run that kept its raw columns (``--set columns=all``), computes what they determine from its
definition alone, and compares. What needs more than the raw columns (bank, load factor, cross-track, the planned curves) is taken from
``results.csv`` as it is. Where the run has a ``verdict.csv``, the rules of ``docs/verdict.md`` are applied to these figures (``paper/``):
words, effects of promises and numbers, counts; so are the lines of its ``readings.csv``. Not judged are ``words.online`` (no figure), the
poses of ``words.single.flyable``, the effects of comparisons, what decides, and the sentences. Where it has an ``arena.csv``, its shares,
ranks and tests are (``arena.py``); where it has a ``risk.csv``, its entries into volumes, shares and ratios (``daa.py``).

Exit code 0: everything agrees. 1: something differs; a table says what. 2: the directory cannot be verified.
"""
