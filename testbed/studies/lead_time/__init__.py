"""How early a threat must be answered: the least lead of a method and of the best open-loop manoeuvre, and what the difference costs."""
