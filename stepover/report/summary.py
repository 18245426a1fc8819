"""Results of a plan and of a simulation, as JSON for programs and as aligned lines for people."""

from __future__ import annotations

import dataclasses
import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.planning.algorithm_1.plan import Plan
from stepover.planning.measures import measure
from stepover.planning.quasi_static.planner import QuasiStaticPlan

if TYPE_CHECKING:
    from stepover.simulation.measurements import Run


def plan_to_json(robot: Robot, obstacle: Obstacle, planned: Plan) -> dict[str, Any]:
    """The values that `plan --json` prints for a plan of Algorithm 1, in SI units."""
    more = {"adaptations": planned.adaptations, "planning_time": planned.planning_time}
    return motion_to_json(robot, obstacle, planned.motion) | more


def quasi_static_to_json(robot: Robot, obstacle: Obstacle, planned: QuasiStaticPlan) -> dict[str, Any]:
    """The values that it prints for a quasi-static plan. `margins_refused`: why the requested margins are not kept."""
    return motion_to_json(robot, obstacle, planned.motion) | {
        "epsilon": planned.epsilon,
        "margins_refused": planned.refused,
    }


def motion_to_json(robot: Robot, obstacle: Obstacle, motion: Motion) -> dict[str, Any]:
    """The values that it prints for the motion of any planner.

    `obstacle.distance` and the margins of `obstacle` are those of the motion. They may differ from the requested ones.
    """
    front, _, _, beside, above = motion.obstacle[:5].tolist()
    kept = {"distance": front, "margin_width": beside, "margin_height": above}
    key = {} if motion.key_configuration is None else {"key_configuration": _key(motion.key_configuration)}
    measures = dataclasses.asdict(measure(robot, motion))
    if motion.zmp_first_stage is None:
        del measures["zmp_rms_first_stage"]
    about = {"robot": motion.robot, "planner": motion.planner, "obstacle": dataclasses.asdict(obstacle) | kept}
    return about | key | measures


def _key(key: np.ndarray) -> dict[str, float]:
    """A key configuration (3,) as named lengths [m]."""
    return dict(zip(("x_ads", "x_hds", "z_hds"), key.tolist(), strict=True))


def plan_summary(result: dict[str, Any]) -> str:
    """A plan as aligned lines, in everyday units."""
    return aligned([*_crossing(result), *_measured(result), *_told_by_the_planner(result)])


def _crossing(result: dict[str, Any]) -> list[tuple[str, str]]:
    """Robot, planner, obstacle, margins and key configuration."""
    obstacle, key = result["obstacle"], result.get("key_configuration")
    rows = [
        ("robot", result["robot"]),
        ("planner", result["planner"]),
        ("obstacle", f"{obstacle['height']:.3f} m high, {obstacle['width']:.3f} m wide, "
                     f"front face at {obstacle['distance']:.3f} m"),
        ("margins", f"{obstacle['margin_height']:.3f} m above, {obstacle['margin_width']:.3f} m before and behind"),
    ]  # fmt: skip
    if key is not None:
        lengths = f"X_ads {key['x_ads']:.3f} m, X_hds {key['x_hds']:.3f} m, Z_hds {key['z_hds']:.3f} m"
        rows.append(("key configuration", lengths))
    return rows


def _measured(result: dict[str, Any]) -> list[tuple[str, str]]:
    """Measures of the motion."""
    over = _or_dash(result["step_over_duration"], "{:.2f} s", 1.0)
    travel = _or_dash(result["com_travel_double_support"], "{:.1f} mm", 1e3)
    first = result.get("zmp_rms_first_stage")
    before = "" if first is None else f" ({_mm(first)} mm before the dynamic filter)"
    return [
        ("duration", f"{result['duration']:.2f} s, of which {over} over the obstacle"),
        ("ZMP error, rms", f"{_mm(result['zmp_rms'])} mm in x, y{before}"),
        ("ZMP error, largest", f"{_mm(result['zmp_error_max'])} mm in x, y"),
        ("ZMP to support's edge", f"{1e3 * result['zmp_margin_min']:.1f} mm at least"),
        ("clearance", f"{1e3 * result['clearance_min']:.1f} mm at least, "
                      f"{result['clearance_link']} at {result['clearance_time']:.3f} s"),
        ("joint margin", f"{math.degrees(result['joint_margin_min']):.1f} degrees at least, "
                         f"{result['joint_margin_joint']}"),
        ("joint speed", f"{result['joint_speed_ratio_max']:.2f} of its limit at most, {result['joint_speed_joint']}"),
        ("CoM, double support", f"{travel} ahead over the obstacle"),
        ("CoM, vertical", f"{result['com_acceleration_ratio_max']:.3f} g at most"),
    ]  # fmt: skip


def _told_by_the_planner(result: dict[str, Any]) -> list[tuple[str, str]]:
    """Values that only some planners give."""
    rows = []
    if "adaptations" in result:
        did, times = result["adaptations"], result["planning_time"]
        rows += [
            ("arms (UBMG)", _arms(did["ubmg"])),
            ("feet (FTA)", _feet(did["fta"])),
            ("dynamic filter", f"{did['filter_passes']} pass{'es' * (did['filter_passes'] != 1)}"),
            ("planned in", f"{times['total']:.2f} s, of which {times['feasibility']:.2f} s in the feasibility unit"),
        ]
    if "torque_ratio_max" in result:
        rows += [
            ("largest torque", f"{result['torque_ratio_max']:.2f} of the limit of {result['torque_ratio_joint']}"),
            ("own links", f"{1e3 * result['self_clearance_min']:.1f} mm apart at least"),
            ("iterations", f"{result['iterations']} in {len(result['attempts'])} problems"),
        ]
    if "epsilon" in result:
        rows.append(("ZMP to CoM", f"{1e3 * result['epsilon']:.2g} mm at most, epsilon"))
        if result["margins_refused"]:
            rows.append(("margins reduced", f"with the requested ones: {result['margins_refused']}"))
    return rows


def run_summary(run: Run) -> str:
    """A simulation as aligned lines."""
    result = run.to_json()
    landing = result["landing_force_peak"]
    saturated = ", ".join(f"{joint} {count}" for joint, count in result["torque_saturated_samples"].items() if count)
    at_limit = "torque beyond its limit" if result["actuators"] == "ideal" else "torque at its limit"
    rows = [
        ("outcome", _outcome(run)),
        ("set-up", f"{result['actuators']} actuators, {result['sole']} soles, "
                   f"{'with' if result['stabilizer'] else 'no'} stabilizer, engine {result['engine']}"),
        ("clearance", f"{_or_dash(result['clearance_min'], '{:.1f} mm at least at the samples', 1e3)}, "
                      f"{result['clearance_link']}"),
        ("obstacle contacts", f"{result['obstacle_contacts']} samples"),
        ("ZMP error, rms", f"{_mm(result['zmp_rms'])} mm in x, y"),
        ("landing force, peak", ", ".join(f"{_landed(landing[leg])} ({leg} leg)" for leg in landing)),
        ("waist error", _or_dash(result["waist_error_max"], "{:.1f} mm at most", 1e3)),
        ("joint torque", _or_dash(result["torque_ratio_max"], "{:.2f} of its limit at most", 1.0)),
        ("joint speed", _or_dash(result["speed_ratio_max"], "{:.2f} of its limit at most", 1.0)),
        (at_limit, f"samples: {saturated}" if saturated else "never"),
        ("duration", f"{result['duration']:.2f} s, simulated at "
                     f"{_or_dash(result['realtime_factor'], '{:.1f} times the speed of real time', 1.0)}"),
        ("state hash", f"{result['state_hash']}"),
    ]  # fmt: skip
    return aligned(rows)


def _outcome(run: Run) -> str:
    """The outcome in a few words. run.explanation says more."""
    what = [said for said, so in (("touched the obstacle", run.obstacle_contacts), ("fell", run.fell)) if so]
    return " and ".join(what) or "crossed"


def _landed(force: float | None) -> str:
    """Peak landing force of a leg, or "no landing"."""
    return f"{force:.0f} N" if force else "no landing"


def _arms(ubmg: dict[str, Any]) -> str:
    """What the upper body motion generator did."""
    if not ubmg["acted"]:
        return "at rest"
    swing, shift = math.degrees(ubmg["arm_swing"]), 1e3 * ubmg["waist_shift_max"]
    return f"swing back by {swing:.1f} degrees, which moves the waist by up to {shift:.1f} mm"


def _feet(fta: dict[str, Any]) -> str:
    """What the feet trajectory adaptor did."""
    if not fta["acted"]:
        return "not adapted"
    back, up, pushed = (1e3 * fta[name] for name in ("foot_back", "waist_raised", "ankle_pushed"))
    return f"{fta['leg']}: {back:.1f} mm back, waist {up:.1f} mm up, ankle pushed by {pushed:.1f} mm"


def aligned(rows: list[tuple[str, str]]) -> str:
    """Lines with names on the left and values on the right."""
    space = max(len(name) for name, _ in rows) + 2
    return "\n".join(f"{name:<{space}}{value}" for name, value in rows)


def as_line(value: Any) -> str:
    """One line of JSON. NaN becomes null."""
    return json.dumps(_plain(value), allow_nan=False)


def _plain(value: Any) -> Any:
    """Numpy's scalars and arrays as Python's own. Values that are not finite become None."""
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _mm(values: list[float]) -> str:
    """Lengths [m] in millimetres."""
    return ", ".join(_or_dash(value, "{:.1f}", 1e3) for value in values)


def _or_dash(value: float | None, form: str, scale: float) -> str:
    """A formatted number, or a dash for a missing one."""
    return "-" if value is None or not math.isfinite(value) else form.format(scale * value)
