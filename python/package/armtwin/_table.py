"""Small tables that print well."""

from __future__ import annotations

import html
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    import pandas as pd

Cell: TypeAlias = str | int | float | bool | None


def shown(cell: Cell) -> str:
    """A cell as people read it: four digits."""
    if cell is None or cell != cell:
        return "-"
    if isinstance(cell, float):
        return f"{cell:.4g}"
    return str(cell)


@dataclass(frozen=True, repr=False)
class Table:
    """Rows under a header.

    Attributes
    ----------
    columns : tuple of str
    rows : tuple of tuple
        One cell per column.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    @staticmethod
    def of(columns: Sequence[str], rows: Sequence[Sequence[Cell]]) -> Table:
        return Table(tuple(columns), tuple(tuple(row) for row in rows))

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[tuple[Cell, ...]]:
        return iter(self.rows)

    def __repr__(self) -> str:
        cells = [list(self.columns), *([shown(c) for c in row] for row in self.rows)]
        widths = [max(len(row[k]) for row in cells) for k in range(len(self.columns))]
        return "\n".join("  ".join(c.ljust(w) for c, w in zip(row, widths)).rstrip() for row in cells)

    def _repr_html_(self) -> str:
        def line(tag: str, row: Sequence[str]) -> str:
            return "<tr>" + "".join(f"<{tag}>{html.escape(c)}</{tag}>" for c in row) + "</tr>"

        body = "".join(line("td", [shown(c) for c in row]) for row in self.rows)
        return f"<table><thead>{line('th', self.columns)}</thead><tbody>{body}</tbody></table>"

    def to_pandas(self) -> pd.DataFrame:
        """As a data frame, with all digits."""
        import pandas as pd

        frame: pd.DataFrame = pd.DataFrame(list(self.rows), columns=list(self.columns))
        return frame
