"""The spanning tree: which joint carries each body, which joints are cut, and in what order bodies are numbered.

Breadth first from the ground, so that the arms of a parallel robot get equal depth; joints marked `cut` are left
out. Bodies are then numbered depth first, each arm in one piece, a motor's rotor just before the body that its
joint carries: the order of the paper's coordinates [phi, theta_1, theta_2, e, ...].
"""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

GROUND = "ground"


@dataclass(frozen=True)
class Link:
    """A body of the tree. `joint` is None for a rotor, whose `motor` is named instead."""

    name: str
    parent: str
    joint: str | None
    forward: bool  #: the joint's first point is on the parent
    motor: str | None = None


@dataclass(frozen=True)
class Tree:
    """Links, parents first, and the names of the joints that close loops."""

    links: tuple[Link, ...]
    cut: tuple[str, ...]


def spanning_tree(
    bodies: Sequence[str],
    joints: Mapping[str, tuple[str, str]],
    marked: Sequence[str] = (),
    rotors: Mapping[str, tuple[str, str]] | None = None,
) -> tuple[Tree, list[str]]:
    """Span the bodies from the ground.

    `joints` maps a joint to its two bodies, `marked` lists those that must close a loop, `rotors` maps a motor with
    a rotor to (joint, stator body). Returns the tree and the bodies that no path of joints ties to the ground.
    """
    neighbours: dict[str, list[tuple[str, str, bool]]] = {name: [] for name in (GROUND, *bodies)}
    for joint, (first, second) in joints.items():
        if joint not in marked:
            neighbours[first].append((joint, second, True))
            neighbours[second].append((joint, first, False))
    children: dict[str, list[Link]] = {name: [] for name in neighbours}
    seen = {GROUND}
    used: set[str] = set()
    queue = deque([GROUND])
    while queue:
        parent = queue.popleft()
        for joint, other, forward in neighbours[parent]:
            if other not in seen:
                seen.add(other)
                used.add(joint)
                children[parent].append(Link(other, parent, joint, forward))
                queue.append(other)
    loose = [name for name in bodies if name not in seen]
    for motor, (joint, stator) in (rotors or {}).items():
        rotor = Link(f"{motor}.rotor", stator, None, True, motor)
        siblings = children[stator]
        places = [k for k, link in enumerate(siblings) if link.joint == joint]
        siblings.insert(places[0] if places else len(siblings), rotor)
    cut = tuple(joint for joint in joints if joint not in used)
    return Tree(_depth_first(children), cut), loose


def _depth_first(children: Mapping[str, list[Link]]) -> tuple[Link, ...]:
    links = []
    stack = list(reversed(children[GROUND]))
    while stack:
        link = stack.pop()
        links.append(link)
        stack.extend(reversed(children.get(link.name, [])))
    return tuple(links)
