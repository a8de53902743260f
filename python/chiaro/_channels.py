"""Channels of a volume and tables of labels, as Python says them."""

from __future__ import annotations

import json
import os
from typing import Any, Mapping

import numpy as np

from .transfer import TransferFunction

MOST = 8
_KEYS = ("name", "color", "gain", "show", "transfer")


def rows_of(channels: Any, count: int | None = None) -> list[dict[str, Any]]:
    """What is said of each channel: names, gains or dicts of name, color, gain, show and transfer."""
    if not isinstance(channels, (list, tuple)):
        raise TypeError(f"channels={channels!r}: must be a list with a name, a gain or a dict for each channel")
    if count is not None and len(channels) != count:
        raise ValueError(f"channels: {len(channels)} are told of, where the array has {count}")
    return [_row(i, one) for i, one in enumerate(channels)]


def _row(i: int, one: Any) -> dict[str, Any]:
    if isinstance(one, str):
        return {"name": one}
    if isinstance(one, (int, float, np.integer, np.floating)) and not isinstance(one, bool):
        one = {"gain": float(one)}
    if not isinstance(one, Mapping):
        raise TypeError(f"channels[{i}]={one!r}: must be a name, a gain or a dict")
    for key in one:
        if key not in _KEYS:
            raise TypeError(f"channels[{i}] has an unknown key {key!r}: {', '.join(_KEYS)} are known")
    gain = float(one.get("gain", 1.0))
    if not 0 <= gain < np.inf:
        raise ValueError(f"channels[{i}]: gain={gain}: must be 0 or more")
    return dict(one)


def settings_of(rows: list[dict[str, Any]], volume: Any) -> list[tuple[Any, ...]]:
    """What a scene keeps of them."""
    kept: list[tuple[Any, ...]] = []
    for row in rows:
        function, source = None, ""
        transfer = row.get("transfer")
        if isinstance(transfer, (str, os.PathLike)):
            source = os.fspath(transfer)
        elif transfer is not None:
            found = TransferFunction.of(transfer, volume)
            function, source = (found._native, "") if found._source is None else (None, found._source)
        kept.append((str(row.get("name", "")), float(row.get("gain", 1.0)), bool(row.get("show", True)), function, source))
    return kept


def color_text(color: Any) -> str:
    """A colour as flags have it; "" for none."""
    if color is None:
        return ""
    if isinstance(color, str):
        return color
    parts = [float(c) for c in color]
    if len(parts) != 3 or not all(0 <= c <= 1 for c in parts):
        raise ValueError(f"color={color!r}: must be three numbers from 0 to 1, or a name")
    return ",".join(repr(c) for c in parts)


def table_text(table: Any) -> str:
    """The JSON of a label table: {value: name}, {value: {...}}, {name: value}, a list of dicts, or the tool's own."""
    if isinstance(table, Mapping) and "labels" not in table and any(isinstance(v, Mapping) for v in table.values()):
        table = [{"value": value, **label} for value, label in table.items()]
    if isinstance(table, Mapping):
        return json.dumps({str(key): value for key, value in table.items()}, default=_plain)
    if isinstance(table, (list, tuple)):
        return json.dumps({"labels": list(table)}, default=_plain)
    raise TypeError(f"label_table={table!r}: must be a file, a dict or a list of dicts")


def _plain(value: Any) -> Any:
    if isinstance(value, TransferFunction):
        return json.loads(value.to_json())
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    raise TypeError(f"label_table holds {value!r}, of which JSON knows nothing")
