"""Where navigation satellites are and how they move, seen from the turning earth."""
