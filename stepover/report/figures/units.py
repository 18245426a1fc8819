"""The results of single units of Algorithm 1 for an obstacle, one figure for each unit that has no other figure."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from stepover.analysis.key_posture import knees_from_straight
from stepover.analysis.stages import after_adaptation, lead_knee, lead_leg_stages
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.algorithm_1.plan import Plan
from stepover.report.figures.adapted import draw_obstacle
from stepover.report.figures.style import (
    FIRST_STAGE,
    LEFT,
    OBSTACLE,
    PLANNED,
    REFERENCE,
    RIGHT,
    WAIST,
    numbered,
    panels,
    shade_phases,
    styled,
    time_axis,
)

SOLE_EVERY = 0.15
"""Time between two soles of a swing [s]."""
FEET = ((1, LEFT, "left"), (-1, RIGHT, "right"))


@styled
def swings(robot: Robot, obstacle: Obstacle, planned: Plan) -> Figure:
    """FTG: the path of each foot over the obstacle from the side, with a sole every 0.15 s."""
    figure, axes = panels(2, 4.6, sharex=True, sharey=True)
    front, every = planned.sequence.front_face, round(SOLE_EVERY / planned.motion.dt)
    sole = np.array([[-robot.foot.heel, 0.0], [robot.foot.toe, 0.0]])
    for axis, kind in zip(axes[:, 0], (LEG_1, LEG_2), strict=True):
        step = planned.sequence.step(kind)
        way = planned.nominal.feet.foot(step.side)[step.lift_off : step.touch_down + 1] - np.eye(1, 7)[0] * front
        colour = LEFT if step.side > 0 else RIGHT
        axis.plot(way[:, 0], way[:, 2], color=REFERENCE, lw=1.0, label="under the ankle")
        for k in range(0, len(way), every):
            pitch = 2.0 * np.arctan2(way[k, 4], way[k, 6])
            turned = sole @ np.array([[np.cos(pitch), -np.sin(pitch)], [np.sin(pitch), np.cos(pitch)]])
            axis.plot(*(turned + way[k, [0, 2]]).T, color=colour, lw=2.0, label="sole" if k == 0 else None)
        draw_obstacle(axis, obstacle, 0.0)
        axis.axhline(0.0, color=REFERENCE, lw=1.0)
        axis.set_aspect("equal")
        axis.set_ylabel("z [m]")
        axis.margins(0.04)
        axis.legend(loc="upper left")
    axes[1, 0].set_xlabel("x from the obstacle's front face [m]")
    numbered(axes, ["leg 1: lands from above", "leg 2: toe down, so that its shank stays upright"])
    return figure


@styled
def cart(robot: Robot, planned: Plan) -> Figure:
    """CWTG1: the cart model's CoM and its ZMP, ahead and across; height and yaw of the waist."""
    motion, first = planned.motion, planned.nominal.first_stage
    figure, axes = panels(2, 4.4, columns=2, sharex=True)
    for axis, column in ((axes[0, 0], 0), (axes[0, 1], 1)):
        axis.plot(motion.time, first.com.zmp[:, column], color=PLANNED, lw=2.2, label="ZMP of the cart")
        axis.plot(motion.time, motion.zmp_reference[:, column], color=REFERENCE, ls="--", lw=0.9, label="desired")
        axis.plot(motion.time, first.com.position[:, column], color=FIRST_STAGE, label="CoM")
        axis.set_ylabel(f"{'xy'[column]} [m]")
    height, yaw = axes[1]
    height.plot(motion.time, 1e2 * first.waist[:, 2], color=WAIST)
    height.axhline(1e2 * planned.key.z_hds, color=REFERENCE, ls="--", lw=0.9)
    height.set_ylabel("height of the waist [cm]")
    height.set_ylim(1e2 * planned.key.z_hds - 1.5, 1e2 * robot.posture.waist_height + 1.5)
    height.annotate(
        "$Z_{hds}$", (motion.time[0], 1e2 * planned.key.z_hds), (4, -4), textcoords="offset points", va="top"
    )
    yaw.plot(motion.time, np.degrees(first.yaw), color=WAIST)
    yaw.set_ylabel("yaw of the waist [deg]")
    for column in range(2):
        time_axis(axes[:, column], motion, names="short")
    numbered(axes, ["ahead", "across", "up", "turned"])
    axes[0, 0].legend(loc="upper left")
    return figure


@styled
def leg_joints(robot: Robot, planned: Plan) -> Figure:
    """IK: knee angles from straight, and the smallest distance of a joint of each leg from its limit."""
    motion, body = planned.motion, robot.body
    figure, axes = panels(2, 3.9, sharex=True)
    knee, room = axes[:, 0]
    bent = knees_from_straight(robot, motion.q)
    spare = np.degrees(np.minimum(motion.q[:, 7:] - body.lower, body.upper - motion.q[:, 7:]))
    for side, colour, name in FEET:
        leg = robot.leg(side)
        column = next(k for k, joint in enumerate(robot.legs.knee) if joint in leg.joints)
        knee.plot(motion.time, bent[:, column], color=colour, label=f"{name} leg")
        own = [body.column(joint) - 7 for joint in leg.joints]
        room.plot(motion.time, spare[:, own].min(axis=1), color=colour)
    for axis, least in ((knee, robot.checks.knee_margin_deg), (room, 0.0)):
        axis.axhline(least, color=OBSTACLE, ls="--", lw=1.2, label="least allowed")
        axis.set_ylim(bottom=-4.0)
    knee.legend(loc="upper left")
    knee.set_ylabel("from straight [deg]")
    room.set_ylabel("from its limit [deg]")
    time_axis(axes[:, 0], motion)
    numbered(axes, ["knees", "joint of each leg nearest to its limit"])
    return figure


@styled
def upper_body(robot: Robot, obstacle: Obstacle, planned: Plan) -> Figure:
    """UBMG: chest and arms, and their effect on the knee of leg 1 before it lands."""
    motion, parts = planned.motion, robot.upper_body
    first = planned.sequence.step(LEG_1)
    figure, axes = panels(1, 3.3, columns=2)
    turned, knee = axes[0]
    chest = np.degrees(motion.q[:, robot.body.column(parts.chest_yaw)])
    shoulder = motion.q[:, robot.body.column(parts.shoulders[0])]
    turned.plot(motion.time, np.degrees(planned.nominal.first_stage.yaw), color=WAIST, label="waist, yaw")
    turned.plot(motion.time, chest, color=PLANNED, label="chest against the waist")
    turned.plot(motion.time, np.degrees(shoulder - shoulder[0]), color=FIRST_STAGE, label="arms, back")
    turned.set(ylabel="angle [deg]", xlabel="time [s]")
    turned.margins(y=0.1)
    time_axis(axes[:, 0], motion, names="short")
    stages = lead_leg_stages(planned)
    looks = (("arms at rest, step 3", stages[0], REFERENCE, "--"), ("arms furthest back", stages[1], FIRST_STAGE, "-"),
             ("the plan, step 7", after_adaptation(planned), PLANNED, "-"))  # fmt: skip
    for name, stage, colour, line in looks:
        time, angle, _ = lead_knee(robot, stage)
        knee.plot(time, angle, color=colour, ls=line, label=name)
    knee.axhline(robot.checks.knee_margin_deg, color=OBSTACLE, ls="--", lw=1.2, label="margin")
    landing = motion.time[first.touch_down]
    knee.set(ylabel="from straight [deg]", xlabel="time [s]", xlim=(landing - 0.6, landing + 0.02), ylim=(0.0, 65.0))
    shade_phases(knee, motion)
    for axis in axes[0]:
        axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)
    numbered(axes, ["chest and arms", "lead knee before it lands"])
    return figure
