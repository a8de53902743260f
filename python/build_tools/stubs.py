"""Type stubs, made from the settings that the extension tells: python stubs.py PACKAGE_FOLDER."""

from __future__ import annotations

import importlib.util
import glob
import os
import sys
from typing import Any

DEVICE = ["device: str = ...", "threads: int = ...", "isa: str = ..."]


def _extension(package: str) -> Any:
    [path] = glob.glob(os.path.join(package, "_chiaro.*.so"))
    spec = importlib.util.spec_from_file_location("_chiaro", path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def type_of(row: dict[str, Any]) -> str:
    kind = row["kind"]
    if row["name"] == "transfer":
        base = "str | os.PathLike[str] | TransferFunction | Iterable[Any] | Callable[..., Any]"
    elif row["name"] == "probe":
        base = "str | os.PathLike[str] | Probe | NDArray[Any]"
    elif row["name"] == "labels":
        base = "str | os.PathLike[str] | Volume | NDArray[Any]"
    elif row["name"] == "label_table":
        base = "str | os.PathLike[str] | Mapping[Any, Any] | Sequence[Mapping[str, Any]]"
    elif kind == "switch":
        base = "bool"
    elif row["choices"] and kind == "integer":
        base = f"Literal[{', '.join(row['choices'])}]"
    elif row["choices"]:
        base = "Literal[" + ", ".join(repr(c) for c in row["choices"]) + "]"
    elif kind == "number":
        base = "float"
    elif kind == "integer":
        base = "int"
    elif kind == "text":
        base = "str | os.PathLike[str]"
    elif kind.startswith("numbers"):
        base = "Sequence[float] | NDArray[Any] | str"
    elif kind == "list":
        base = "float | str | Sequence[Any]"
    else:
        base = "float | str | Sequence[Any]"
    return base + (" | None" if row["optional"] else "")


def value_type(row: dict[str, Any]) -> str:
    """What reading a setting gives."""
    kind = row["kind"]
    if kind.startswith("numbers"):
        base = "tuple[float, ...]"
    elif kind == "list":
        base = "list[Any]"
    elif kind in ("text", "form"):
        base = "str"
    else:
        return type_of(row)
    return base + (" | None" if row["optional"] else "")


def write(package: str) -> None:
    rows = _extension(package).settings()
    given = [f"{row['name']}: {type_of(row)} = ..." for row in rows]
    given.append("channels: Sequence[Any] | None = ...")
    groups: dict[str, list[Any]] = {}
    for row in rows:
        groups.setdefault(row["group"].lower().replace(" ", "_"), []).append(row)
    classes, members = [], []
    for group, of in groups.items():
        name = "_" + "".join(part.capitalize() for part in group.split("_"))
        classes.append(f"class {name}:\n" + "".join(f"    {row['name']}: {value_type(row)}\n" for row in of))
        if group not in {"volume", "transfer_function", *(row["name"] for row in rows)}:
            members.append(f"    @property\n    def {group}(self) -> {name}: ...\n")
    read = "".join(f"    @property\n    def {row['name']}(self) -> {value_type(row)}: ...\n" for row in rows)
    edit = "".join(
        f"    @property\n    def {row['name']}(self) -> {value_type(row)}: ...\n    @{row['name']}.setter\n    def {row['name']}(self, value: {type_of(row)}) -> None: ...\n"
        for row in rows
    )
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "chiaro.pyi.in"), encoding="utf-8") as file:
        text = file.read()
    comma = lambda parts: ", ".join(parts)  # noqa: E731
    for key, value in {
        "{settings}": comma(given),
        "{device}": comma(DEVICE),
        "{groups}": "\n".join(classes),
        "{read}": read + "".join(members),
        "{edit}": edit + "".join(members),
    }.items():
        text = text.replace(key, value)
    with open(os.path.join(package, "__init__.pyi"), "w", encoding="utf-8") as file:
        file.write(text)
    with open(os.path.join(package, "_chiaro.pyi"), "w", encoding="utf-8") as file:
        file.write("# The extension's own names are private: chiaro's modules wrap them.\nfrom typing import Any\n\ndef __getattr__(name: str) -> Any: ...\n")


if __name__ == "__main__":
    write(sys.argv[1])
