"""Tables of results: written as CSV, compared with the committed ones."""

import csv
import shutil
import typing

from .common import RESULTS, ROOT, commit, machine

DATA = ROOT / "docs/data"
_measured = {}  # rows by table, of this call of the program


class Table(typing.NamedTuple):
    name: str
    keys: tuple    # columns that say which row it is
    values: tuple  # columns that are compared
    is_shown: typing.Callable = lambda row: True


def read(path):
    if not path.exists():
        return []
    with open(path, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def committed(name):
    return read(DATA / f"{name}.csv")


def newest(name):
    """What has just been measured, or else what is committed."""
    return _measured.get(name) or committed(name)


def save(name, rows):
    _measured[name] = rows
    RESULTS.mkdir(parents=True, exist_ok=True)
    columns = list(dict.fromkeys(column for row in rows for column in row))
    with open(RESULTS / f"{name}.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def publish(name):
    shutil.copyfile(RESULTS / f"{name}.csv", DATA / f"{name}.csv")
    print(f"wrote docs/data/{name}.csv")


def ratio(new, old):
    try:
        return f"{float(new) / float(old):.2f}"
    except (TypeError, ValueError, ZeroDivisionError):
        return "-"


def lines(table, rows, old_rows):
    """Row, quantity, new value, committed value, their ratio."""
    old = {tuple(row.get(key) for key in table.keys): row for row in old_rows}
    for row in filter(table.is_shown, rows):
        names = tuple(row[key] for key in table.keys)
        before = old.get(names, {})
        for value in table.values:
            if row.get(value):
                was = before.get(value) or "-"
                yield " ".join(filter(None, names)), value, row[value], was, ratio(row[value], was)


def compare(table):
    """Prints the new table next to the committed one."""
    rows, old_rows = _measured[table.name], committed(table.name)
    print(f"\n{table.name}: {commit()} ({machine()})")
    if old_rows and "commit" in old_rows[0]:
        print(f"committed: {old_rows[0]['commit']} ({old_rows[0]['settings']})")
    heads = ("", "quantity", "new", "committed", "new/committed")
    body = [heads, *lines(table, rows, old_rows)]
    widths = [max(len(line[k]) for line in body) for k in range(len(heads))]
    for line in body:
        print("  ".join((word.ljust if k < 2 else word.rjust)(width)
                        for k, (word, width) in enumerate(zip(line, widths))))
