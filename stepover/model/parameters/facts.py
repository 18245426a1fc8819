"""Facts of a robot that its URDF cannot contain, as frozen dataclasses. robot.toml gives them."""

from __future__ import annotations

import types
from dataclasses import dataclass
from typing import Any

from stepover.model.parameters.entry import MODEL, fact, parameter

Pair = tuple[float, float]


@dataclass(frozen=True)
class Legs:
    """The joints of the legs."""

    right: tuple[str, ...] = fact("", "six joints from the hip to the sole")
    left: tuple[str, ...] = fact("", "the same of the left leg")
    knee: tuple[str, ...] = fact("", "the knees: the fourth joints of the legs")


@dataclass(frozen=True)
class Foot:
    """The right foot, seen from the ankle, which is the leg's last joint. The left foot mirrors y."""

    ankle_height: float = fact("m", "ankle above the lowest point of the foot")
    sole_length: float = fact("m", "F_W of Fig. 2")
    heel: float = fact("m", "length of the whole foot behind the ankle")
    toe: float = fact("m", "length of the whole foot ahead of the ankle")
    contact_x: Pair = fact("m", "flat patch that bears load, from heel to toe", sign="any", rising=True)
    contact_y: Pair = fact("m", "the same patch across, from right to left", sign="any", rising=True)


@dataclass(frozen=True)
class Outline:
    """The leg of Fig. 1 in the knee's frame: points x ahead, z up along the shank."""

    front: tuple[Pair, ...] = fact("m", "front of knee and shank, from the top down", sign="any")
    rear: tuple[Pair, ...] = fact("m", "rear of knee and shank, from the bottom up", sign="any")


@dataclass(frozen=True)
class Posture:
    """Half-sitting: the posture at the start and end of every motion."""

    angles_deg: types.MappingProxyType[str, float] = fact("deg", "joint angles; other joints stand at 0", sign="any")
    waist_height: float = fact("m", "height of the root above the floor, with both soles on it", scale=MODEL)
    feet_apart: float = fact("m", "sideways distance between the ankles", scale=MODEL)

    def __getstate__(self) -> dict[str, Any]:
        """What pickle and deepcopy take: a mappingproxy is nothing for them."""
        return {**self.__dict__, "angles_deg": dict(self.angles_deg)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Take it back."""
        self.__dict__.update(state, angles_deg=types.MappingProxyType(state["angles_deg"]))


@dataclass(frozen=True)
class UpperBody:
    """Joints of the upper body that the planner moves, and how (Sec. III-D)."""

    chest_yaw: str = fact("", "joint that turns against the waist's yaw (III-C3)")
    shoulders: tuple[str, ...] = fact("", "pitch joints that swing the arms back (III-D)")
    arm_swing_max_deg: float = parameter(
        25.0, "deg", "largest swing of the arms: as far as the waist turns", source="P S2"
    )
    arm_swing_sizes: int = parameter(5, "count", "number of swings tried, in equal parts of the largest")
    arms_start: float = parameter(
        0.10, "share", "part of leg 1's swing at which the arms start", sign="not negative", below=("arms_back",)
    )
    arms_back: float = parameter(0.95, "share", "part of leg 1's swing at which the arms are back")
    arms_forth: float = parameter(0.80, "share", "part of leg 2's swing at which the arms hang down again")
    knee_spare_deg: float = parameter(3.0, "deg", "bend of the knees beyond the limit of the checks")
