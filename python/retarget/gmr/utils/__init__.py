"""Loaders of human motions."""
