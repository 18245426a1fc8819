"""A slider for the obstacle's height beside the feasibility domains, for a notebook that is open. Sec. II-A."""

from __future__ import annotations

from io import BytesIO

import ipywidgets as widgets

from stepover.model.feasibility_domain import Reading, feasibility_domains
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.report.figures.feasibility import domains_overlaid


def height_slider(
    robot: Robot, width: float, height: float, reading: Reading | None = None, points: int = 200, highest: float = 0.4
) -> widgets.VBox:
    """A slider and the domains for the height it stands at. Without a browser it shows the first one.

    Args:
        robot: the robot.
        width: of the obstacle [m].
        height: where the slider stands at first [m].
        reading: of the text.
        points: of the grid, along either axis.
        highest: end of the slider [m].
    """
    slider = widgets.FloatSlider(
        value=1e2 * height, min=1.0, max=1e2 * highest, step=0.5, description="height [cm]", continuous_update=False
    )
    picture = widgets.Image(format="png", width=900)

    def draw(_: object = None) -> None:
        picture.value = domains_picture(robot, Obstacle(slider.value / 1e2, width), reading, points)

    slider.observe(draw, "value")
    draw()
    return widgets.VBox([slider, picture])


def domains_picture(robot: Robot, obstacle: Obstacle, reading: Reading | None = None, points: int = 200) -> bytes:
    """The domains for an obstacle as the bytes of a PNG, their areas in the title."""
    domains = feasibility_domains(robot, obstacle, reading, points)
    areas = ", ".join(f"({equation}) {domains.area(equation):.3f}" for equation in domains.masks)
    title = f"obstacle {1e2 * obstacle.height:.1f} cm high, {1e2 * obstacle.width:.1f} cm wide; areas [m²]: {areas}"
    file = BytesIO()
    domains_overlaid(domains, title).savefig(file, format="png", metadata={"Software": None})
    return file.getvalue()
