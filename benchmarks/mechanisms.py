"""Mechanisms of any size: a chain of flexible links, four-bars side by side."""

from fmbd.model import Model, load_model_text


def chain(links: int, elements: int = 4) -> Model:
    """A hanging chain of slender steel links, the first hinged to ground, which starts horizontally."""
    bodies, joints = [], []
    for k in range(links):
        bodies.append(
            f"  link{k}: {{type: beam, length: 0.5, elements: {elements}, material: steel, section: round}}"
        )
        end = f"link{k - 1}.end" if k else "ground.origin"
        joints.append(f"  hinge{k}: {{type: revolute, between: [{end}, link{k}.start]}}")
    text = [
        "fmbd: 1",
        "gravity: [0, -9.81]",
        "materials: {steel: {density: 7850, youngs_modulus: 2.1e11}}",
        "sections: {round: {type: circle, diameter: 0.01}}",
        "bodies:",
        *bodies,
        "joints:",
        *joints,
    ]
    return load_model_text("\n".join(text))


def four_bars(loops: int) -> Model:
    """Parallelograms of uniform bars side by side, upright, moving to the right at 1 m/s: IFToMM benchmark A02."""
    bar = "{type: rigid, shape: {type: rod, length: 1}, mass: 1, points: {end: [1, 0]}}"
    cranks, couplers = range(loops + 1), range(loops)
    text = [
        "fmbd: 1",
        "gravity: [0, -9.81]",
        "ground:",
        "  points:",
        *(f"    O{k}: [{k}, 0]" for k in cranks),
        "bodies:",
        *(f"  crank{k}: {bar}" for k in cranks),
        *(f"  coupler{k}: {bar}" for k in couplers),
        "joints:",
        *(f"  foot{k}: {{type: revolute, between: [ground.O{k}, crank{k}.origin]}}" for k in cranks),
        *(f"  left{k}: {{type: revolute, between: [crank{k}.end, coupler{k}.origin]}}" for k in couplers),
        *(
            f"  right{k}: {{type: revolute, between: [crank{k + 1}.end, coupler{k}.end], cut: true}}"
            for k in couplers
        ),
        "initial:",
        "  joints:",
        *(f"    foot{k}: pi/2" for k in cranks),
        "  rates: {foot0: -1}",
        "  hints:",
        *(f"    left{k}: -pi/2" for k in couplers),
    ]
    return load_model_text("\n".join(text))
