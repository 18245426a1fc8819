"""Links on fixed joints, made one with what they are fixed to.

A URDF has many of them: frames of sensors, of hands and feet, a root without a body. Physics engines treat them
differently: PyBullet gives a link without an inertial 1 kg.
"""

from __future__ import annotations

from dataclasses import replace

from stepover.model.description.links import Description, Link, Place


def merged(description: Description, fixed: set[str]) -> Description:
    """The description with the child of each fixed joint merged into its parent.

    Args:
        description: the robot.
        fixed: names of its fixed joints.
    """
    links = {link.name: link for link in description.links}
    moving = [joint for joint in description.joints if joint.name not in fixed]
    into: dict[str, tuple[str, Place]] = {}
    for joint in _children_first(description, fixed):
        links[joint.parent] = _absorbed(links[joint.parent], links.pop(joint.child), joint.place)
        into[joint.child] = joint.parent, joint.place
    joints = []
    for joint in moving:
        parent, place = joint.parent, joint.place
        while parent in into:
            parent, outer = into[parent]
            place = outer.then(place)
        joints.append(replace(joint, parent=parent, place=place))
    root = next(name for name in links if name not in {joint.child for joint in joints})
    rest = [link for name, link in links.items() if name != root]
    return Description(description.name, (links[root], *rest), tuple(joints))


def _children_first(description: Description, fixed: set[str]) -> list:
    """Fixed joints, those further out first."""
    above = description.joint_above

    def depth(name: str) -> int:
        count = 0
        while name in above:
            name, count = above[name].parent, count + 1
        return count

    joints = [joint for joint in description.joints if joint.name in fixed]
    return sorted(joints, key=lambda joint: -depth(joint.child))


def _absorbed(whole: Link, part: Link, place: Place) -> Link:
    """A link with the mass and the shapes of another that is fixed to it at a place."""
    inertia = whole.inertia
    if part.inertia.mass > 0.0:
        other = part.inertia.placed(place)
        inertia = other if inertia.mass <= 0.0 else inertia.plus(other)
    solids = tuple(replace(solid, place=place.then(solid.place)) for solid in part.solids)
    return replace(whole, inertia=inertia, solids=whole.solids + solids)
