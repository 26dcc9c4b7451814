"""The paper put to the test: its printed numbers, recomputed one by one."""
