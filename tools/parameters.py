"""Write docs/parameters.md, the list of all values of a robot: python -m tools.parameters."""

from __future__ import annotations

from dataclasses import MISSING, Field, fields
from pathlib import Path
from typing import Any

from stepover.model.parameters.entry import MODEL, entry_of
from stepover.model.parameters.scaling import RULES
from stepover.model.parameters.slow import SLOW
from stepover.robots.loading import FACTS, PARAMETERS

TARGET = Path(__file__).resolve().parents[1] / "docs" / "parameters.md"
HEAD = """\
# All values of a robot

<!-- Written by python -m tools.parameters; do not edit. -->

[own_robot.md](own_robot.md) says how to write a `robot.toml`. This page lists what may stand in it. Facts come first: a
`robot.toml` must give them, but for those that follow from the URDF. All others are parameters with HRP-2's values as
defaults. A `robot.toml` names a parameter only to override it, in the table of that name:

```toml
[walk]
step_length = 0.22
```

The column *scales* says how the default of another robot follows from HRP-2's. A scaled value has two digits.

| rule | default of another robot, with its leg, sole and mass in units of HRP-2's |
|---|---|
{rules}
| {model} | what the URDF says; an override must be within 10 % of it |
| | HRP-2's value |

Times and shares do not scale. Neither do distances that keep an obstacle's margin, and the resolution of a search.
Marks: P published, D derived from published figures, E estimated. [data/hrp2](../data/hrp2/README.md) names the sources
S1 to S8 and [13]; II ... V are sections of the paper.
"""
SLOWLY = """
## Slow motions

With `speed_limits="respect"` these values take the place of a robot's own. They are HRP-2's, found at 25 cm (E), and
scale by the rules above. `slow = false` at the top of a `robot.toml` keeps the robot's own.

| value | where speed limits are kept |
|---|---|
"""


def page() -> str:
    """The text of docs/parameters.md."""
    rules = "\n".join(f"| {rule} | HRP-2's value {words} |" for rule, (words, _) in RULES.items())
    parts = [HEAD.format(rules=rules, model=MODEL)]
    for heading, tables in (("Facts", FACTS), ("Parameters", PARAMETERS)):
        parts.append(f"\n## {heading}\n")
        parts += [_table(name, kind) for name, kind in tables.items()]
    rows = [f"| `{table}.{name}` | {_shown(value)} |" for table, part in SLOW.items() for name, value in part.items()]
    return "".join(parts) + SLOWLY + "\n".join(rows) + "\n"


def _table(name: str, kind: type[Any]) -> str:
    """A table of robot.toml: what it is about, and a row for each of its values."""
    head = "| key | default | unit | meaning | scales | mark |\n|---|---|---|---|---|---|"
    rows = "\n".join(_row(field) for field in fields(kind))
    return f"\n### {name}\n\n{(kind.__doc__ or '').strip().splitlines()[0]}\n\n{head}\n{rows}\n"


def _row(field: Field[Any]) -> str:
    """A value's row."""
    entry, has_default = entry_of(field), field.default is not MISSING
    scale = entry.scale or ""
    default = _shown(field.default) if has_default else "" if entry.scale == MODEL else "required"
    mark = entry.source if has_default else ""
    return f"| `{field.name}` | {default} | {entry.unit} | {entry.reason} | {scale} | {mark} |"


def _shown(value: Any) -> str:
    """A value as TOML has it."""
    return str(list(value)) if isinstance(value, tuple) else str(value)


if __name__ == "__main__":
    TARGET.write_text(page(), encoding="utf-8")
