"""The file of results: there whole or not at all after every cell, so that a run can be stopped and gone on with."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from sdfc.api.request import RequestError
from sdfc.image.write import write
from sdfc.measure.bench.record import Cell, Record

FORMAT = 1  # of the file
RESULTS = "results.json"


@dataclass(slots=True)
class Store:
    """Records by cell, and the machine they were made on; `path` is where they are kept (None: nowhere)."""

    path: Path | None = None
    machine: dict[str, str] = field(default_factory=dict)
    settings: dict[str, str] = field(default_factory=dict)
    records: dict[Cell, Record] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)  # scenes on which sdfc failed; not kept

    def kept(self, cell: Cell, key: str) -> Record | None:
        """The record of this cell, if it was made from the same."""
        record = self.records.get(cell)
        return record if record is not None and record.key == key else None

    def add(self, record: Record) -> None:
        """Keep it, in the file as well."""
        self.records[record.cell] = record
        self.save()

    def save(self) -> None:
        """Write the file."""
        if self.path is not None:
            write(self.path, self.text().encode())

    def text(self) -> str:
        """The file."""
        rows = [r.to_json() for r in ordered(self.records.values())]
        head = {"format": FORMAT, "machine": self.machine, "settings": self.settings}
        lines = ",\n".join(json.dumps(row, allow_nan=False) for row in rows)  # a record a line: differences read well
        return f'{json.dumps(head, indent=1)[:-2]},\n "records": [\n{lines}\n]}}\n'


def ordered(records: Iterable[Record]) -> list[Record]:
    """By scene, size, tolerance, budget, tracer."""
    return sorted(records, key=lambda r: r.cell.order)


def read(path: Path) -> Store:
    """A file of results, or the folder that has one. Raises RequestError."""
    file = path / RESULTS if path.is_dir() else path
    try:
        given = json.loads(file.read_text())
        if given["format"] != FORMAT:
            raise RequestError(f"'{file}' is of format {given['format']}; this sdfc reads format {FORMAT}")
        records = [Record.from_json(row) for row in given["records"]]
        machine, settings = dict(given["machine"]), dict(given["settings"])
    except OSError as error:
        raise RequestError(f"cannot read '{file}': {error.strerror}") from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise RequestError(f"'{file}' is no file of bench results: {error}") from error
    return Store(file, machine, settings, {r.cell: r for r in records})


def opened(folder: Path | None, machine: Mapping[str, str], settings: Mapping[str, str]) -> Store:
    """The results that are in the folder (made where it is not there yet), to be added to."""
    if folder is None:
        return Store(None, dict(machine), dict(settings))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RequestError(f"cannot make the folder '{folder}': {error.strerror}") from error
    file = folder / RESULTS
    store = read(file) if file.exists() else Store(file)
    store.machine, store.settings = dict(machine), dict(settings)
    return store
