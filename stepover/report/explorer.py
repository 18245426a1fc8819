"""Sliders with a picture, for an open notebook. Without a browser, the picture shows the sliders' first values.

The picture is an ordinary output of the notebook that is replaced in place. So it stays in an executed notebook.
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
"""First value, lowest value, highest value and step of a slider, all [m]."""
RESOLUTION = 130
"""Resolution of the picture [dots per inch]: lower than in files, so that it appears sooner."""
KEPT = 64
"""Number of pictures kept in memory, so that an earlier picture appears at once."""


class Explorer:
    """Sliders in centimetres, and a picture that is drawn anew when a slider is released.

    Attributes:
        sliders: the sliders by name.
        status: line of text below the sliders.
        picture: the current picture as PNG.
    """

    def __init__(self, draw: Callable[..., Figure], **sliders: Slider) -> None:
        """Draw the picture for the first values of the sliders.

        Args:
            draw: makes a figure from lengths [m], which have the names of the sliders.
            sliders: the sliders by name.
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
        """Draw for the current values of the sliders, and replace the picture."""
        self.status.value = "one moment ..."
        lengths = {name: slider.value / 1e2 for name, slider in self.sliders.items()}
        self.picture = self._draw(**lengths)
        if self._shown:
            self._place.update(Image(self.picture))
        self.status.value = ", ".join(f"{name} {1e2 * length:.3g} cm" for name, length in lengths.items())

    def _ipython_display_(self) -> None:
        """Show the sliders with the picture below them, in a notebook's cell."""
        display(widgets.VBox([*self.sliders.values(), self.status]))
        self._place.display(Image(self.picture))
        self._shown = True


def obstacle_sliders(robot: Robot, obstacle: Obstacle) -> Explorer:
    """Sliders for the obstacle's height, width and margin. Each change is planned at once, or rejected with a reason.

    Args:
        robot: the robot.
        obstacle: first values of the sliders. One slider sets both margins.
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
    """A slider for the obstacle's height, with the feasibility domains of Sec. II-A.

    Args:
        robot: the robot.
        width: width of the obstacle [m].
        height: first value of the slider [m].
        reading: interpretation of the paper's text.
        points: number of grid points along each axis.
    """

    def draw(height: float) -> Figure:
        domains = feasibility_domains(robot, Obstacle(height, width), reading, points)
        areas = ", ".join(f"({equation}) {domains.area(equation):.3f}" for equation in domains.masks)
        size = f"obstacle {1e2 * height:.1f} cm high, {1e2 * width:.1f} cm wide"
        return domains_overlaid(domains, f"{size}; areas [m²]: {areas}")

    return Explorer(draw, height=(height, 0.01, 0.40, 0.005))


def _slider(name: str, first: float, low: float, high: float, step: float) -> widgets.FloatSlider:
    """A slider [cm] for a length [m]. Its range is widened to include its first value."""
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
