"""Which key configuration, with which options? The order in which Algorithm 1 is tried.

What the paper describes comes first, with the authors' control points of FTG, and with the arms at rest while the knees
allow it; then UBMG; then what is added beyond the paper. Later swings of FTG come last: they reach further without any
addition, but land less softly. With each of these options the key configurations are tried in the order of FU.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable

import numpy as np

from stepover.errors import Infeasible, LimitBroken, OutOfReach, TrailingLegBlocked
from stepover.model.robot import Robot
from stepover.planning.algorithm_1.feasibility import KeyConfiguration
from stepover.planning.algorithm_1.plan import Options, Plan
from stepover.planning.checks import ZMP

Attempt = Callable[[KeyConfiguration, Options], Plan]
"""Plans with a key configuration and options, or raises Infeasible."""
Broken = defaultdict[str, list[tuple[KeyConfiguration, float]]]
"""By the limit, the key configurations that broke it, and by how much."""
LEAN = 0.6
"""How far a leg leans where it reaches furthest: hip to ankle ahead over hip to ankle down. It is 0.5 to 0.7 for
obstacles of 20 to 25 cm. Under 20 cm hardly any attempt fails for want of reach."""

HARDLY = 1e-4
"""m or rad: a limit that is broken by so much less with the next waist is not kept with the lowest."""
SEVERAL = 4
"""Attempts with a higher waist or a shorter step that broke a limit by no more, until the rest is not tried."""


def options_in_order(robot: Robot, arms: str, extras: bool, speed_limits: str) -> list[Options]:
    """What to try, in this order; where speed limits are to be kept, everything that is allowed at once."""
    both = ("off", "auto") if arms == "auto" else (arms,)
    swings = range(1, len(robot.late_swing.leg1_descent) + 1)
    levels = range(1, len(robot.beyond_paper.zmp_toe) + 1) if extras else ()
    every = [Options(some) for some in both] + [Options(arms, level=level) for level in levels]
    every += [Options(some, late=late) for late in swings for some in both]
    if speed_limits == "respect":
        return [Options(arms, level=max(levels, default=0))]
    return every


def first_plan(robot: Robot, keys: list[KeyConfiguration], options: list[Options], attempt: Attempt) -> Plan:
    """The plan for the first options and key configuration that work.

    Raises:
        Infeasible: nothing works; what is short by least with the last options. An adapted leg that still collides
            came further than one that does not reach.
    """
    errors: list[Infeasible] = []
    for some in options:
        found, errors = _first_key(robot, keys, some, attempt)
        if found is not None:
            return found
    raise _nearest_miss(errors)


def plannable(robot: Robot, keys: list[KeyConfiguration], options: list[Options], attempt: Attempt) -> bool:
    """Whether some key configuration works with all that may be used, or with the paper's methods at least.

    Other options stand between these two and hardly ever work where neither does; a search for the nearest obstacle
    that asks many times can do without them.
    """
    return any(_first_key(robot, keys, some, attempt, any_of_them=True)[0] for some in (options[-1], options[0]))


def _nearest_miss(errors: list[Infeasible]) -> Infeasible:
    """The error that lacks least; an adapted leg that still collides lacks less than one that does not reach."""
    explained = [error.explain() if isinstance(error, TrailingLegBlocked) else error for error in errors]
    return min(explained, key=lambda error: (isinstance(error, OutOfReach), error.short))


def _first_key(
    robot: Robot,
    keys: list[KeyConfiguration],
    options: Options,
    attempt: Attempt,
    any_of_them: bool = False,
) -> tuple[Plan | None, list[Infeasible]]:
    """The plan for the first key configuration that works, or for any of them, or None; and why others do not.

    A failed attempt rules others out. Where FTA fails, the next step length waits for the one after it, which may rule
    it out. What fails as the robot walks fails with every key configuration.
    """
    apart = robot.feasibility.step_length_more_step
    left = [key for key in keys if _is_whole((key.x_ads - keys[0].x_ads) / apart)]
    found, errors, beyond = None, [], 0.0
    broken: Broken = defaultdict(list)
    while left:
        key = next((key for key in left if key.x_ads > beyond), left[0])
        before, beyond = left[: left.index(key)], 0.0
        try:
            found, left = attempt(key, options), before
            if any_of_them:
                break
        except Infeasible as error:
            if error.nearest is not None or error.walking:
                raise
            error.forget_frames()
            errors.append(error)
            left.remove(key)
            left = _not_ruled_out(left, key, error, broken)
            if isinstance(error, TrailingLegBlocked):
                beyond = key.x_ads + 1.5 * apart
    return found, errors


def _not_ruled_out(
    left: list[KeyConfiguration], key: KeyConfiguration, error: Infeasible, broken: Broken
) -> list[KeyConfiguration]:
    """Those of some key configurations that may work although one of them failed.

    Where a sole is out of reach by some length, the waist must be lower by more. Where FTA cannot free the trailing
    leg, that is for want of reach as well, so the waist must be lower. A longer step needs a lower waist still.

    Where a lower waist or a longer step breaks the same limit as before, and by hardly less, one that is lower and
    longer does not mend it: the ZMP's after one such attempt, another limit after several, since it may depend on how
    FTA frees the leg.
    """
    if isinstance(error, (OutOfReach, TrailingLegBlocked)):
        lower = np.hypot(1.0, LEAN) * error.short if isinstance(error, OutOfReach) else 0.0
        return [other for other in left if _demand(other) < _demand(key) - lower]
    if isinstance(error, LimitBroken):
        worse = sum(_no_better(key, error.excess, *one) for one in broken[error.limit])
        broken[error.limit].append((key, error.excess))
        if worse >= (1 if error.limit.startswith(ZMP) else SEVERAL):
            return [other for other in left if other.x_ads < key.x_ads or other.z_hds > key.z_hds]
    return left


def _no_better(key: KeyConfiguration, excess: float, before: KeyConfiguration, excess_before: float) -> bool:
    """Whether a lower waist or a longer step than before breaks a limit by hardly less."""
    return key.x_ads >= before.x_ads and key.z_hds <= before.z_hds and excess >= excess_before - HARDLY


def _demand(key: KeyConfiguration) -> float:
    """What a key configuration asks of a leg's reach, as a height of the waist [m].

    A longer step takes the waist half as much further from either foot, which a leaning leg makes up for by going down.
    """
    return key.z_hds + LEAN * key.x_ads / 2.0


def _is_whole(number: float) -> bool:
    """Whether a number is whole, but for rounding."""
    return abs(number - round(number)) < 1e-6
