"""Whether a simulation that was run anew is the stored one, in a word for a table.

The physics repeats to the bit on one machine. Another processor rounds otherwise, and a foot that bounces makes more of
that; then the outcome must be the same, and the number that counts nearly so.
"""

from __future__ import annotations

YES, NEARLY, NO = "yes, to the bit", "but for rounding", "no"
CLOSE = 0.002
"""m: two clearances that hardly differ."""


def agreement(same: bool, now: float | None, then: float | None, share: float = 0.0, room: float = 0.0) -> str:
    """YES for the same bits, NEARLY for numbers that hardly differ, else NO.

    Args:
        same: whether all that is compared is equal.
        now: the number that counts; None where there is none, which must be so both times.
        then: the same, as stored.
        share: of it by which it may differ.
        room: and by how much more, in its own unit.
    """
    if same:
        return YES
    if now is None or then is None:
        return NEARLY if now is then else NO
    return NEARLY if abs(now - then) <= share * abs(then) + room else NO
