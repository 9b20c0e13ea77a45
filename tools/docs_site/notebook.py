"""Notebooks: run in separate kernels, and converted to HTML."""

from __future__ import annotations

import html
import os
import tempfile
from pathlib import Path
from unittest import mock

import nbclient
import nbformat
from traitlets.config import Config

_SECONDS_PER_CELL = 300


def read(file: Path) -> nbformat.NotebookNode:
    """Returns a notebook."""
    return nbformat.read(file, as_version=4)


def executed(file: Path) -> nbformat.NotebookNode:
    """Runs a notebook in its folder; returns it with its outputs.

    Raises:
        nbclient.exceptions.CellExecutionError: a cell raised an exception.
    """
    book = read(file)
    nbformat.validate(book)
    with tempfile.TemporaryDirectory() as private:
        folders = ("IPYTHONDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "TMPDIR")
        # Sockets in a private folder instead of ports that everyone on the machine can open.
        config = Config({"KernelManager": {"transport": "ipc", "connection_file": f"{private}/kernel.json"}})
        with mock.patch.dict(os.environ, dict.fromkeys(folders, private)):
            nbclient.NotebookClient(book, timeout=_SECONDS_PER_CELL, kernel_name="python3", config=config,
                                    resources={"metadata": {"path": str(file.parent)}}).execute()
    return book


def cell_html(cell: nbformat.NotebookNode, code: str) -> str:
    """Returns a cell of code and its outputs; `code` is its highlighted source."""
    outputs = "".join(f'<div class="output">{_output(each)}</div>' for each in cell.outputs)
    return f"<pre><code>{code}</code></pre>{outputs}"


def _output(output: nbformat.NotebookNode) -> str:
    if output.output_type == "stream":
        return f"<pre>{html.escape(output.text)}</pre>"
    data = output.data
    if "text/html" in data:
        return data["text/html"]
    if "image/png" in data:
        return f'<img alt="" src="data:image/png;base64,{data["image/png"]}">'
    return f"<pre>{html.escape(data.get('text/plain', ''))}</pre>"
