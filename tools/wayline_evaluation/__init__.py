"""How good estimates are: against truth, against recorded fixes, against what is possible."""
