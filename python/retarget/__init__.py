"""Human motion capture to joint trajectories of humanoid robots."""

from retarget._retarget import __version__, version_text

__all__ = ["__version__", "version_text"]
