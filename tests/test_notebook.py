"""docs/notebook.ipynb runs from top to bottom, and is stored without what it prints."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOK = Path(__file__).parents[1] / "docs" / "notebook.ipynb"


@pytest.fixture
def notebook() -> Any:
    return nbformat.read(NOTEBOOK, as_version=4)


def test_it_is_stored_without_outputs(notebook: Any) -> None:
    """Else every run of it would be a change."""
    nbformat.validate(notebook)
    assert [cell.id for cell in notebook.cells] == [f"cell-{k:02}" for k in range(len(notebook.cells))]
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code)
    assert all(len(cell.source.splitlines()) <= 6 for cell in code)  # all of it in a few lines


@pytest.mark.slow
def test_it_runs(notebook: Any, tmp_path: Path) -> None:
    done = NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [list(cell.outputs) for cell in done.cells if cell.cell_type == "code"]
    pictures = [any("image/png" in output.get("data", {}) for output in cell) for cell in outputs]
    assert sum(pictures) == 4  # series, the cable, two floaters, vessel and floater
    texts = ["".join(output.get("text", "") for output in cell) for cell in outputs]
    assert any("natural frequencies [Hz]:" in text for text in texts)
    assert [output for cell in outputs for output in cell if output.get("name") == "stderr"] == []
    assert (tmp_path / "heave.fmu").stat().st_size > 100_000
