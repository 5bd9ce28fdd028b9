"""Functional Mock-up Units of underwater cables, from a scene file."""

__version__ = "0.1.0"
