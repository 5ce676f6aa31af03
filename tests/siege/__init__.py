"""Long fault tests: `scripts/siege ROW`; pytest runs the same with short times."""
