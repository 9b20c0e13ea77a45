"""NumPy, or None where it is not installed."""

try:
    import numpy
except ImportError:
    numpy = None
