"""Runs the notebooks beside this file, each in a folder of its own; `--keep` stores what they show."""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient

#: Bytes of a kept notebook: outputs stay small.
LARGEST = 200_000


def main() -> None:
    keep = "--keep" in sys.argv
    for path in sorted(Path(__file__).parent.glob("*.ipynb")):
        notebook = nbformat.read(path, as_version=4)  # type: ignore[no-untyped-call]
        begun = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            NotebookClient(notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": folder}}).execute()
        print(f"{path.name}: {time.monotonic() - begun:.1f} s")
        if keep:
            for cell in notebook.cells:
                cell.metadata.pop("execution", None)
            notebook.metadata.pop("widgets", None)
            nbformat.write(notebook, path)  # type: ignore[no-untyped-call]
        assert path.stat().st_size <= LARGEST, f"{path.name} is large: {path.stat().st_size} bytes"


if __name__ == "__main__":
    main()
