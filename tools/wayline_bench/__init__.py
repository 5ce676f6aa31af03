"""Measures Wayline beside named yardsticks, both in the same run."""
