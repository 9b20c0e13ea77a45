"""Pages that play motions in a browser or a notebook."""

from __future__ import annotations

import html
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from retarget import _retarget
from retarget._api import Bounds, StrPath, load, load_motion
from retarget._errors import ArgumentTypeError, UsageError

# Pixels of a player in a notebook.
_PLAYER_HEIGHT = 560


class Page:
    """An HTML page that loads nothing else. A notebook shows it as a player."""

    def __init__(self, text: str) -> None:
        self.html = text
        """The whole page."""

    def save(self, path: StrPath) -> Path:
        """Writes the page and returns its path.

        Raises:
            UsageError: the name of another kind of file.
            RunError: the file cannot be written; an existing one stays.
        """
        _retarget.write_drawing(path, self.html.encode(), True)
        return Path(os.fsdecode(path))

    def _repr_html_(self) -> str:
        # A separate frame keeps the styles of page and notebook apart.
        return (f'<iframe srcdoc="{html.escape(self.html)}" sandbox="allow-scripts" width="100%" '
                f'height="{_PLAYER_HEIGHT}" style="border: 0"></iframe>')

    def __repr__(self) -> str:
        return f"<retarget.Page: {len(self.html) / 1e6:.2f} MB>"


def view(motions: _retarget.Motion | StrPath | Sequence[_retarget.Motion | StrPath],
         output: StrPath | None = None, *, robot: _retarget.Robot | StrPath | None = None,
         clip: _retarget.Clip | StrPath | None = None, labels: str | Sequence[str] | None = None,
         gates: Mapping[str, Bounds] | StrPath | Literal[False] | None = None,
         meshes: StrPath | None = None, title: str = "") -> Page:
    """Makes a page that plays motions, each with its robot, source, figures and faults.

    Args:
        motions: one or several, which are played side by side; files need `robot`.
        output: also write the page to this file.
        robot: the robot of the files, or an argument of Robot().
        clip: the human motion to show next to motions that have no source of their own.
        labels: one per motion; None: the names of files, or of the motions.
        gates: as for evaluate().
        meshes: a folder of meshes or another model of the robot; None: the meshes of its model.
        title: window title; empty: the labels.

    Raises:
        UsageError: no motion, another number of labels, a file without a robot, an output that
            is not HTML.
        InputError: a bad file; implausible values, such as a root 100 km away.
        RunError: the output cannot be written; an existing file stays.
    """
    several: list[Any] = [motions] if _is_one(motions) else list(motions)  # type: ignore
    if not several:
        raise UsageError("motions: expected at least one")
    if isinstance(labels, str):
        labels = [labels]
    wrong = next((each for each in several if not _is_one(each)), None)
    if wrong is not None:
        raise ArgumentTypeError(f"motions: expected motions or paths, found {type(wrong).__name__}")
    names = [_label(each) for each in several] if labels is None else list(labels)
    if len(names) != len(several):
        raise UsageError(f"labels: expected {len(several)} of them, found {len(names)}")
    if clip is not None and not isinstance(clip, _retarget.Clip):
        clip = load(clip)
    if isinstance(gates, Mapping):
        gates = dict(gates)
    loaded = [_motion(each, robot) for each in several]
    clips = [None if motion.source is not None else clip for motion in loaded]
    mesh_path = "" if meshes is None else os.fsdecode(meshes)
    page = Page(_retarget.page_html(loaded, clips, names, gates, mesh_path, title))
    if output is not None:
        page.save(output)
    return page


def picture(motion: _retarget.Motion, output: StrPath | None = None, *, poses: int = 6,
            title: str = "") -> bytes:
    """Draws a motion as a strip of poses, below its source if it has one.

    Args:
        output: also write the picture to this file; if its name ends in .svg, the picture is an SVG.
        poses: number of poses, 1 to 100; the first and the last frame are included.
        title: of an SVG.

    Returns:
        The bytes of the PNG, or of the SVG.

    Raises:
        UsageError: another number of poses, the name of another kind of file.
        RunError: the file cannot be written; an existing one stays.
    """
    if not isinstance(motion, _retarget.Motion):
        raise ArgumentTypeError(f"motion: expected a Motion, found {type(motion).__name__}")
    if isinstance(poses, bool) or not hasattr(poses, "__index__"):
        raise ArgumentTypeError(f"poses: expected a whole number, found {poses!r}")
    file = None if output is None else Path(os.fsdecode(output))
    is_svg = file is not None and file.suffix.lower() == ".svg"
    content = _retarget.strip_bytes(motion, poses, is_svg, title)
    if file is not None:
        _retarget.write_drawing(file, content, False)
    return content


def player_of(motion: _retarget.Motion) -> str:
    """Called by the module: the HTML of a motion in a notebook."""
    return view(motion)._repr_html_()


def _is_one(motions: object) -> bool:
    return isinstance(motions, (_retarget.Motion, str, bytes, os.PathLike))


def _label(motion: Any) -> str:
    return Path(motion.name if isinstance(motion, _retarget.Motion) else os.fsdecode(motion)).stem


def _motion(motion: Any, robot: _retarget.Robot | StrPath | None) -> _retarget.Motion:
    if isinstance(motion, _retarget.Motion):
        return motion
    if os.path.isdir(motion):
        raise UsageError(f"{os.fsdecode(motion)}: expected a motion, found a folder; gallery() "
                         "makes pages of a batch")
    if robot is None:
        raise UsageError(f"{os.fsdecode(motion)}: a file needs robot=")
    return load_motion(motion, robot)
