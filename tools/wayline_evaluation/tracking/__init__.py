"""The study of papers/001, tight coupling: what a known velocity is worth to a receiver's loops."""
