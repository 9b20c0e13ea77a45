"""The package as it is imported."""

import retarget


def test_version() -> None:
    assert retarget.version_text().startswith(f"retarget {retarget.__version__}")
