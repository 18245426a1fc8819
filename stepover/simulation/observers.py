"""Who watches the physics: what an observer is told, and the one that shows progress."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stepover.control.estimator import Estimate
from stepover.simulation.engine import Contacts, Engine
from stepover.simulation.touch import Touch


@dataclass(frozen=True, eq=False)
class Sample:
    """The robot at one sample of the motion; forces and torques are means over the steps since the sample before.

    Attributes:
        index: of the sample, from 0.
        last: index of the sample at which the simulation ends; it moves to an earlier one after a fall.
        q: (nq,) measured configuration.
        dq: (J,) joint speeds [rad/s].
        torque: (J,) of the motors [N m].
        saturated: (J,) whether a motor gave all its torque in any step.
        bush: (6,) deflections of the rubber, as Engine.bush gives them [m, rad].
        contacts: points of all the steps.
        touch: what they come to.
        estimate: what a controller estimated last; None without one.
    """

    index: int
    last: int
    q: np.ndarray
    dq: np.ndarray
    torque: np.ndarray
    saturated: np.ndarray
    bush: np.ndarray
    contacts: Contacts
    touch: Touch
    estimate: Estimate | None


class Observer:
    """Watches a simulation without changing it; one that needs less overrides less."""

    def stepped(self, engine: Engine) -> None:
        """A time step has passed; the engine's contacts are left for the sample."""

    def sampled(self, sample: Sample) -> None:
        """A sample has been reached, the first one included."""


class Progress(Observer):
    """Says now and then which share is done."""

    EVERY = 100
    """Samples between two reports."""

    def __init__(self, report: Callable[[float], None]) -> None:
        """Tell shares, 0 to 1, to a function."""
        self._report = report

    def sampled(self, sample: Sample) -> None:
        """Report every so often, and at the end."""
        if sample.index and (sample.index % self.EVERY == 0 or sample.index == sample.last):
            self._report(sample.index / sample.last)
