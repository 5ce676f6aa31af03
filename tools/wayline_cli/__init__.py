"""The `wayline` command."""
