"""The paper's fourteen figures, numbered as it numbers them, from the geometry that the testbed flies with; its drawings are not copied.

Figures 1 to 7 are sketches in the paper; here they show the encounters of section 5, in the readings in which the obstacles are threats
by the paper's own test. Every number beside them is computed when they are drawn.
"""
