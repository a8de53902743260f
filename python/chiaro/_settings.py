"""Settings by name: what the flags of the tool take, as values of Python."""

from __future__ import annotations

import difflib
import functools
import os
from typing import Any, Iterable, Mapping

import numpy as np

from . import _chiaro

#: settings of a call that are none of a picture
DEVICE = ("device", "threads", "isa")


@functools.lru_cache(maxsize=None)
def table() -> dict[str, dict[str, Any]]:
    """All settings by name, as include/chiaro/describe.h tells them."""
    return {row["name"]: row for row in _chiaro.settings()}


@functools.lru_cache(maxsize=None)
def groups() -> dict[str, list[str]]:
    """The settings' names by group: camera, sampling, ..."""
    found: dict[str, list[str]] = {}
    for name, row in table().items():
        found.setdefault(row["group"].lower().replace(" ", "_"), []).append(name)
    return found


def grouped() -> dict[str, list[str]]:
    """Those groups that are attributes: other things have the names of the rest, whose settings stand alone."""
    return {group: names for group, names in groups().items() if group not in ("volume", "transfer_function", *table())}


def meant(name: str, known: Iterable[str]) -> str:
    near = difflib.get_close_matches(name, list(known), n=1)
    return f"; did you mean '{near[0]}'?" if near else ""


#: settings of a scene that are lists, which no flag takes
LISTS = ("channels",)


def refuse_unknown(call: str, names: Iterable[str], more: Iterable[str] = ()) -> None:
    more = (*LISTS, *more)
    for name in names:
        if name not in table() and name not in more:
            raise TypeError(f"{call}() got an unknown setting '{name}'{meant(name, [*table(), *more])}")


def _number(value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    return repr(float(value))


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def text(name: str, value: Any) -> str:
    """What the flag would take. Raises TypeError for a value of a wrong type."""
    row = table()[name]
    if value is None:
        if not row["optional"]:
            raise TypeError(f"{name}=None: must be given a value (default {row['default']!r})")
        return ""
    if isinstance(value, (str, os.PathLike)):
        if row["kind"] in ("number", "integer") and not row["choices"]:
            raise TypeError(f"{name}={value!r}: must be a number, not text")
        return os.fspath(value)
    if row["kind"] == "switch" or isinstance(value, (bool, np.bool_)):
        if not isinstance(value, (bool, np.bool_)) or row["kind"] != "switch":
            wanted = "True or False" if row["kind"] == "switch" else row["form"] or "a number"
            raise TypeError(f"{name}={value!r}: must be {wanted}")
        return _number(value)
    if _is_number(value):
        if row["kind"] == "integer" and float(value) != int(value):
            raise TypeError(f"{name}={value!r}: must be a whole number")
        return _number(int(value) if row["kind"] == "integer" else value)
    if row["repeats"] and isinstance(value, (list, tuple)):
        return ";".join(_one(name, part) for part in (value if not _is_row(value) else [value]))
    if row["kind"] != "number" and row["kind"] != "integer" and isinstance(value, (list, tuple, np.ndarray)):
        return ("x" if "x" in row["form"] else ",").join(_part(name, part) for part in value)
    raise TypeError(f"{name}={value!r}: must be {row['form'] or row['kind']}, not {type(value).__name__}")


def _is_row(value: Any) -> bool:
    """A row of numbers stands for itself; a list of them for several."""
    return isinstance(value, tuple) and bool(value) and _is_number(value[0])


def _part(name: str, part: Any) -> str:
    if isinstance(part, str):
        return part
    if _is_number(part):
        return _number(part)
    raise TypeError(f"{name}: {part!r} must be a number, not {type(part).__name__}")


def _one(name: str, part: Any) -> str:
    if isinstance(part, (list, tuple, np.ndarray)):
        return ",".join(_part(name, p) for p in part)
    return _part(name, part)


def texts(settings: Mapping[str, Any]) -> dict[str, str]:
    return {name: text(name, value) for name, value in settings.items()}


def explained() -> str:
    """The settings as text for docstrings: name, what it does, range, default."""
    lines = []
    for group, names in groups().items():
        lines.append(f"\n{group.replace('_', ' ').capitalize()}")
        for name in names:
            row = table()[name]
            extent = f" ({row['range']})" if row["range"] else ""
            choices = f" {', '.join(row['choices'])}." if row["choices"] else ""
            lines.append(f"    {name} = {row['default']!r}: {row['sentence']}{extent}.{choices}")
    return "\n".join(lines)
