"""What every Wayline service imports, and nothing of a service."""

__version__ = "0.1.0"
