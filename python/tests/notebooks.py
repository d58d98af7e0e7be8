"""Runs the notebooks named, or all, from the first cell to the last, and says how long each took. Usage: notebooks.py [NOTEBOOK…]

They must be stored without outputs: what a reader sees is what came on his own machine.
"""

import os
import sys
import tempfile
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

FOLDER = Path(__file__).parents[1] / "notebooks"
LIMIT = 300  # seconds a cell


def said(notebook: nbformat.NotebookNode) -> str:
    """What its cells printed."""
    outputs = (output for cell in notebook.cells for output in cell.get("outputs", ()))
    return "".join(output.text for output in outputs if output.output_type == "stream" and output.name == "stdout")


def run(path: Path) -> bool:
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    if any(cell.get("outputs") or cell.get("execution_count") for cell in notebook.cells):
        print(f"{path.name}: has stored outputs: clear them")
        return False
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        client = NotebookClient(notebook, timeout=LIMIT, kernel_name="python3", resources={"metadata": {"path": folder}})
        try:
            client.execute()
        except CellExecutionError as error:
            print(f"{path.name}: {error}")
            return False
        finally:
            # To be looked at by hand.
            if kept := os.environ.get("GEO_ADAPT_NOTEBOOKS"):
                nbformat.write(notebook, Path(kept) / path.name)
    print(said(notebook))
    print(f"{path.name}: {time.monotonic() - began:.0f} s", flush=True)
    return True


def main() -> int:
    paths = [Path(name) for name in sys.argv[1:]] or sorted(FOLDER.glob("*.ipynb"))
    os.environ["PYVISTA_OFF_SCREEN"] = "true"
    return int(not all([run(path) for path in paths]))


if __name__ == "__main__":
    sys.exit(main())
