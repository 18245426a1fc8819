"""Sliders over a picture, for a notebook that is open; without a browser the picture stands where the sliders do.

The picture is an ordinary output, replaced in place: it stays in an executed notebook that nobody has open.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from io import BytesIO

import ipywidgets as widgets
from IPython.display import DisplayHandle, Image, display
from matplotlib.figure import Figure

from stepover.analysis.planar.feasibility_domain import Reading, feasibility_domains
from stepover.errors import Infeasible
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.planning.algorithm_1.planner import plan_in_detail
from stepover.report.figures.crossing import crossing, refused
from stepover.report.figures.feasibility import domains_overlaid

Slider = tuple[float, float, float, float]
"""Where it stands first, its ends, its step: all [m]."""
RESOLUTION = 130
"""Of the picture [dots per inch]: less than that of a file, so that it is there sooner."""
KEPT = 64
"""Pictures that are kept, so that a slider that goes back need not wait."""


class Explorer:
    """Sliders in centimetres, and a picture that is drawn anew when one of them is let go.

    Attributes:
        sliders: by name.
        status: what it is doing.
        picture: PNG that is shown now.
    """

    def __init__(self, draw: Callable[..., Figure], **sliders: Slider) -> None:
        """Draw the picture where the sliders stand at first.

        Args:
            draw: figure for lengths [m], named as the sliders.
            sliders: by name.
        """
        self._draw = lru_cache(maxsize=KEPT)(lambda **lengths: _png(draw(**lengths)))
        self.sliders = {name: _slider(name, *places) for name, places in sliders.items()}
        self.status = widgets.Label("move a slider")
        self._place = DisplayHandle()
        self._shown = False
        self._redraw()
        for slider in self.sliders.values():
            slider.observe(self._redraw, "value")

    def _redraw(self, _: object = None) -> None:
        """Draw for where the sliders stand now, and replace the picture."""
        self.status.value = "one moment ..."
        lengths = {name: slider.value / 1e2 for name, slider in self.sliders.items()}
        self.picture = self._draw(**lengths)
        if self._shown:
            self._place.update(Image(self.picture))
        self.status.value = ", ".join(f"{name} {1e2 * length:.3g} cm" for name, length in lengths.items())

    def _ipython_display_(self) -> None:
        """As the last value of a cell: the sliders, and the picture under them."""
        display(widgets.VBox([*self.sliders.values(), self.status]))
        self._place.display(Image(self.picture))
        self._shown = True


def obstacle_sliders(robot: Robot, obstacle: Obstacle) -> Explorer:
    """Height, width and margin of the obstacle: each change is planned at once. Refusals say why, in one line.

    Args:
        robot: the robot.
        obstacle: where the sliders stand first; one margin for both.
    """

    def draw(height: float, width: float, margin: float) -> Figure:
        wanted = Obstacle(height, width, margin, margin)
        try:
            return crossing(robot, plan_in_detail(robot, wanted, look_for_nearest=False))
        except Infeasible as reason:
            return refused(robot, wanted, str(reason))

    return Explorer(
        draw, height=(obstacle.height, 0.01, 0.35, 0.005), width=(obstacle.width, 0.01, 0.30, 0.005),
        margin=(obstacle.margin_height, 0.0, 0.06, 0.005),
    )  # fmt: skip


def height_slider(
    robot: Robot, width: float, height: float, reading: Reading | None = None, points: int = 200
) -> Explorer:
    """The obstacle's height beside the feasibility domains of Sec. II-A.

    Args:
        robot: the robot.
        width: of the obstacle [m].
        height: where the slider stands first [m].
        reading: of the text.
        points: of the grid, along either axis.
    """

    def draw(height: float) -> Figure:
        domains = feasibility_domains(robot, Obstacle(height, width), reading, points)
        areas = ", ".join(f"({equation}) {domains.area(equation):.3f}" for equation in domains.masks)
        size = f"obstacle {1e2 * height:.1f} cm high, {1e2 * width:.1f} cm wide"
        return domains_overlaid(domains, f"{size}; areas [m²]: {areas}")

    return Explorer(draw, height=(height, 0.01, 0.40, 0.005))


def _slider(name: str, first: float, low: float, high: float, step: float) -> widgets.FloatSlider:
    """A slider [cm] for a length [m]; its ends make room for where it stands first."""
    value, low, high, step = (round(1e2 * length, 9) for length in (first, min(low, first), max(high, first), step))
    return widgets.FloatSlider(
        value=value, min=low, max=high, step=step, description=f"{name} [cm]", readout_format=".1f",
        continuous_update=False, style={"description_width": "7em"}, layout={"width": "36em"},
    )  # fmt: skip


def _png(figure: Figure) -> bytes:
    """A figure as the bytes of a PNG."""
    file = BytesIO()
    figure.savefig(file, format="png", dpi=RESOLUTION, metadata={"Software": None})
    return file.getvalue()
