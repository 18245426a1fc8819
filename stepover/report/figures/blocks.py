"""Fig. 4: the units in the order in which the planner calls them, and the values that flow between them."""

from __future__ import annotations

import textwrap
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from stepover.analysis.block_diagram import INPUT, OUTPUT, Block, Diagram
from stepover.report.figures.style import OBSTACLE, PLANNED, REFERENCE, SIMULATED, panels, styled

KEY, STEPS, ZMP = r"$X_{ads}, X_{hds}, Z_{hds}$", "steps", r"$ZMP_{des}(t)$"
SYMBOLS = {
    (INPUT, "obstacle"): (r"$o_h, o_w, s_h, s_w$",),
    ("FU", "key"): (KEY,), ("FU", "x_ads"): (KEY,), ("FU", "x_hds"): (KEY,), ("FU", "z_hds"): (KEY,),
    ("FTG", "sequence"): (STEPS, ZMP), ("FTG", "phase"): (STEPS,), ("FTG", "support"): (STEPS,),
    ("FTG", "time"): (STEPS,), ("FTG", "front_face"): (STEPS,),
    ("FTG", "zmp"): (ZMP,), ("FTG", "ftg"): (r"$L_1(t), R_1(t)$",),
    ("CWTG1", "first"): (r"$CoM_1(t)$", r"$W_1(t)$"), ("CWTG1", "waist"): (r"$W_1(t)$",),
    ("UBMG", "q"): (r"$UB(t)$",), ("UBMG", "waist_shift"): (r"$\Delta W(t)$",),
    ("IK", "q"): (r"$Legs(t), UB(t)$",),
    ("CWTG2", "waist"): (r"$W_2(t)$",),
    ("FTA", "feet"): (r"$L(t), R(t)$",), ("FTA", "left"): (r"$L(t), R(t)$",), ("FTA", "right"): (r"$L(t), R(t)$",),
    ("FTA", "raised"): (r"$W(t)$",),
}  # fmt: skip
"""The paper's symbols for the values. A value without a symbol appears under its name in the planner."""
ROW, HALF, LEADING = 0.76, (0.475, 0.31), 0.0165
"""Row height over column width; half a block in columns, wide and high; line height over font size [1/pt]."""

BOLD, CODE = {"weight": "bold"}, {"family": "DejaVu Sans"}
Line = tuple[str, float, dict[str, Any]]


@styled
def block_diagram(diagram: Diagram) -> Figure:
    """Blocks down the diagonal. A value lies in the row of the block that makes it and the column of its user."""
    columns = [block.name for block in diagram.blocks] + [OUTPUT]
    count = len(columns)
    figure, axes = panels(1, 7.16 * ROW * (count + 0.66) / count)
    axis = axes[0, 0]
    axis.set_axis_off()
    axis.set(xlim=(-0.5, count - 0.5), ylim=(-ROW * (count - 0.56), 1.22 * ROW), aspect="equal")
    places = {name: place for place, name in enumerate([INPUT, *columns], start=-1)}
    for (maker, taker), names in sorted(diagram.flows.items(), key=lambda flow: places[flow[0][0]]):
        _flow(axis, places[maker], places[taker], _label(maker, names))
    for k, block in enumerate(diagram.blocks):
        _block(axis, k, "#EAF1F7", _lines(block))
    _block(axis, count - 1, "white", [(OUTPUT, 9.5, BOLD), ("checked, then", 7.0, {}), ("returned", 7.0, {})])
    axis.text(3.5, 1.06 * ROW, "the obstacle and its safety margins", ha="center", va="bottom", fontsize=7.5,
              color=SIMULATED)  # fmt: skip
    for k, (colour, text) in enumerate((
        (OBSTACLE, "→ ↓  passed on"),
        (PLANNED, "← ↑  passed back, repeated until FTA has nothing left to adapt after the filter"),
    )):  # fmt: skip
        axis.text(-0.47, -ROW * (count - 1.3 + 0.28 * k), text, ha="left", va="center", fontsize=7.5, color=colour)
    return figure


def _flow(axis: Axes, maker: int, taker: int, label: str) -> None:
    """A line from the maker's row to the taker's column, with a label where row and column meet."""
    back = taker < maker
    colour = SIMULATED if maker < 0 else PLANNED if back else OBSTACLE
    x, y, end = taker, -ROW * maker, -ROW * taker + (-1 if back else 1) * HALF[1]
    start = maker + (-1 if back else 1) * HALF[0] if maker >= 0 else 0.0
    axis.plot([start, x], [y, y], color=colour, lw=1.0, zorder=1)
    axis.annotate("", (x, end), (x, y), arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.0,
                  "shrinkA": 0, "shrinkB": 0, "mutation_scale": 8}, zorder=2)  # fmt: skip
    around = {"boxstyle": "round,pad=0.22", "fc": "white", "ec": colour, "lw": 0.6}
    axis.text(x, y, label, ha="center", va="center", fontsize=7, bbox=around, zorder=3, linespacing=1.25)


def _label(maker: str, names: tuple[str, ...]) -> str:
    """The values in the paper's symbols, each once."""
    symbols = [symbol for name in names for symbol in SYMBOLS.get((maker, name), (name,))]
    return "\n".join(sorted(set(symbols), key=lambda symbol: (symbol == STEPS, symbols.index(symbol))))


def _block(axis: Axes, place: int, colour: str, lines: list[Line]) -> None:
    """A box on the diagonal, with lines of (text, size [pt], font) in its middle."""
    corner, size = (place - HALF[0], -ROW * place - HALF[1]), (2.0 * HALF[0], 2.0 * HALF[1])
    axis.add_patch(FancyBboxPatch(corner, *size, boxstyle="round,pad=0,rounding_size=0.05", fc=colour, ec=REFERENCE,
                                  lw=0.9, zorder=4))  # fmt: skip
    y = -ROW * place + LEADING * sum(points for _, points, _ in lines) / 2.0
    for text, points, font in lines:
        axis.text(place, y - LEADING * points / 2.0, text, ha="center", va="center_baseline", fontsize=points,
                  zorder=5, **font)  # fmt: skip
        y -= LEADING * points


def _lines(block: Block) -> list[Line]:
    """Number and abbreviation of a unit, its full name, and its functions."""
    meaning = textwrap.wrap(block.meaning, 21)
    return [
        (f"{block.step}: {block.name}", 9.5, BOLD),
        *((line, 7.0, {}) for line in meaning),
        *((name, 5.7, CODE) for name in block.functions),
    ]
