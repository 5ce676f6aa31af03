"""The study of papers/003: what smoothing makes of GPS speeds, accelerations and trip distances."""
