"""Human frames in the format of the published class."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

#: {body: [position (3,), metres, Z up; quaternion (4,), w x y z]}
Frame = dict[str, list[np.ndarray]]


def frames_of(names: Sequence[str], positions: np.ndarray, rotations: np.ndarray,
              sources: Sequence[tuple[int, int]] | None = None) -> list[Frame]:
    """Returns one dictionary per frame, with views of one copy of the arrays.

    Args:
        names: body names.
        positions: (F, J, 3).
        rotations: (F, J, 4).
        sources: the joints for position and rotation of each body; None: the body itself.
    """
    pairs = sources if sources is not None else [(i, i) for i in range(len(names))]
    bodies = list(zip(names, pairs))
    return [{name: [place[i], turn[j]] for name, (i, j) in bodies}
            for place, turn in zip(positions, rotations)]
