"""The algebra: states, models, what each sensor measures of them, one gate for all."""
