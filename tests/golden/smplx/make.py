"""Makes tables.json and expected.csv of this folder, beside which retarget.gmr is tested.

    PYTHONPATH=build/release/python PYTHON tests/golden/smplx/make.py SHARED/oracle

PYTHON has mink, MuJoCo and DAQP. The tables are this project's own, in the form of those for
SMPL-X: its body names, every kind of entry in use. The frames are those of the sample walk.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import mujoco
import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
HEIGHT = 1.7  # metres

FORWARD = [0.5, 0.5, 0.5, 0.5]
LEG = [-0.5, 0.5, 0.5, -0.5]
FOOT = [-0.70710678, 0.70710678, 0.0, 0.0]
ARM = [0.5, 0.5, -0.5, -0.5]
FOREARM = [0.70710678, 0.70710678, 0.0, 0.0]

# Robot body: human body, weights of position and rotation in both tables, offsets.
ROWS: dict[str, tuple[str, tuple[float, float], tuple[float, float], list[float], list[float]]] = {
    "pelvis": ("pelvis", (0, 12), (80, 6), [0.0, 0.0, 0.02], FORWARD),
    "torso_link": ("spine3", (0, 60), (2, 12), [0.0, 0.01, 0.0], FORWARD),
    **{f"{side}_{link}": (f"{side}_{body}", first, second, offset, turn)
       for side, y in (("left", 1.0), ("right", -1.0))
       for link, body, first, second, offset, turn in (
           ("hip_yaw_link", "hip", (0, 8), (12, 4), [0.0, 0.01 * y, 0.0], LEG),
           ("knee_link", "knee", (0, 9), (11, 6), [0.0, 0.0, 0.0], LEG),
           ("ankle_roll_link", "foot", (60, 10), (45, 12), [-0.03, 0.0, 0.0], FOOT),
           ("shoulder_yaw_link", "shoulder", (0, 40), (6, 30), [0.0, 0.0, 0.0], ARM),
           ("elbow_link", "elbow", (0, 15), (9, 5), [0.0, 0.0, 0.01 * y], FOREARM),
           ("wrist_yaw_link", "wrist", (0, 7), (13, 0), [0.0, 0.0, 0.0], FOREARM))},
}


def tables() -> dict:
    """In the published form."""
    arms = ("shoulder", "elbow", "wrist")
    return {
        "robot_root_name": "pelvis", "human_root_name": "pelvis", "ground_height": 0.01,
        "human_height_assumption": 1.75,
        "human_scale_table": {human: 0.78 if human.endswith(arms) else 0.87
                              for human, *_ in ROWS.values()},
        **{f"use_ik_match_table{k + 1}": True for k in range(2)},
        **{f"ik_match_table{k + 1}": {robot: [human, *weights[k], offset, turn]
                                      for robot, (human, *weights, offset, turn) in ROWS.items()}
           for k in range(2)},
    }


def main(oracle: str) -> None:
    sys.path[:0] = [oracle, str(ROOT / "python/tests")]
    import retarget_oracle
    from test_gmr_oracle import golden_frames

    config = tables()
    lines = json.dumps(config, indent=1)
    (HERE / "tables.json").write_text(lines + "\n", encoding="utf-8")
    frames = golden_frames()
    xml = retarget_oracle.kinematic_mjcf(str(ROOT / "robots/unitree_g1/model.xml"))
    model = mujoco.MjModel.from_xml_string(xml)
    stacked = {name: tuple(np.array([frame[name][part] for frame in frames]) for part in range(2))
               for name in frames[0]}
    targets = retarget_oracle.make_targets(stacked, config, HEIGHT)
    qpos, errors = retarget_oracle.retarget(model, config, targets, len(frames))
    last = [row[~np.isnan(row)][-1] for row in errors[:, 1]]
    np.savetxt(HERE / "expected.csv", np.column_stack([qpos[:, 1], last]), fmt="%.10f",
               delimiter=",")


if __name__ == "__main__":
    main(sys.argv[1])
