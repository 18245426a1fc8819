"""Whether a repeated simulation agrees with the stored one, in a few words for a table.

On one machine the physics repeats to the bit. Another processor rounds differently, and a bouncing foot amplifies the
difference. Then the outcome must be equal, and the main number nearly equal.
"""

from __future__ import annotations

YES, NEARLY, NO = "yes, to the bit", "but for rounding", "no"
CLOSE = 0.002
"""Difference of two clearances that counts as small [m]."""


def agreement(same: bool, now: float | None, then: float | None, share: float = 0.0, room: float = 0.0) -> str:
    """YES for equal bits, NEARLY for a small difference, else NO.

    Args:
        same: whether all compared values are equal.
        now: the main number now, or None. None only agrees with None.
        then: the stored main number.
        share: allowed relative difference.
        room: additional allowed difference, in the unit of the number.
    """
    if same:
        return YES
    if now is None or then is None:
        return NEARLY if now is then else NO
    return NEARLY if abs(now - then) <= share * abs(then) + room else NO
