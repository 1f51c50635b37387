"""Runs a notebook from its first cell to its last."""

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

path = Path(sys.argv[1])
notebook = nbformat.read(path, as_version=4)
place = {"metadata": {"path": str(path.parent)}}
NotebookClient(notebook, timeout=300, kernel_name="python3", resources=place).execute()
shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
if not any("text/html" in output.get("data", {}) for output in shown):
    sys.exit("no cell shows a run")
