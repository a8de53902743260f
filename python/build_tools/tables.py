"""The tables of docs/python.md, from the settings that the package tells: tables.py [DOCS] writes them there, or prints."""

from __future__ import annotations

import sys

from chiaro import _settings

BEGIN, END = "<!-- settings: made by python/build_tools/tables.py -->\n", "<!-- end of settings -->\n"


def tables() -> str:
    text = ""
    for group, names in _settings.groups().items():
        text += f"\n### {group.replace('_', ' ').capitalize()}\n\n| name | what it does | takes | default |\n| --- | --- | --- | --- |\n"
        for name in names:
            row = _settings.table()[name]
            takes = ", ".join(f"`{c}`" for c in row["choices"]) or row["range"] or {"switch": "True, False"}.get(row["kind"], row["form"] or row["kind"])
            text += f"| `{name}` | {row['sentence']} | {takes} | `{row['default']!r}` |\n".replace("|`", "| `")
    return text


def with_tables(page: str) -> str:
    before, rest = page.split(BEGIN)
    return before + BEGIN + tables() + "\n" + END + rest.split(END)[1]


if __name__ == "__main__":
    if len(sys.argv) < 2:
        print(tables())
    else:
        with open(sys.argv[1], encoding="utf-8") as file:
            page = file.read()
        with open(sys.argv[1], "w", encoding="utf-8") as file:
            file.write(with_tables(page))
