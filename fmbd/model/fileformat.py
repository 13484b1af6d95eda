"""The keys of a model file, in the order in which they are read."""

from functools import cache
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

from pydantic import AfterValidator, Field, PlainValidator, TypeAdapter

from fmbd.model.base import Number, Pair, Part, Text
from fmbd.model.beam import BeamEntry
from fmbd.model.controllers import ControllerField
from fmbd.model.initial import Initial
from fmbd.model.joints import Joint
from fmbd.model.loads import LoadField
from fmbd.model.materials import Material
from fmbd.model.motors import MotorField
from fmbd.model.names import described
from fmbd.model.points import GroundEntry, Name
from fmbd.model.rigid import RigidBodyEntry
from fmbd.model.sections import SectionField
from fmbd.model.signals import SignalField
from fmbd.model.simulation import Simulation
from fmbd.model.springs import SpringField

FORMAT = 1


def supported_format(value: Any) -> int:
    """The version of the file format; raises ValueError for another than this one."""
    if isinstance(value, bool) or value != FORMAT:
        raise ValueError(f"this program reads format {FORMAT}, not {described(value)}")
    return FORMAT


BodyField = Annotated[
    Annotated[RigidBodyEntry, AfterValidator(RigidBodyEntry.resolve)]
    | Annotated[BeamEntry, AfterValidator(BeamEntry.resolve)],
    Field(discriminator="type"),
]


class ModelFile(Part):
    """A planar flexible multibody model."""

    fmbd: Annotated[int, PlainValidator(supported_format, json_schema_input_type=Literal[1])]
    """Version of the file format."""
    name: Text | None = None
    """Name of the model; the file's name when left out."""
    description: Text | None = None
    """What the model is."""
    parameters: dict[Name, Number] = Field(default_factory=dict)
    """Numbers by name, for use in expressions."""
    gravity: Pair = (0.0, 0.0)
    """Acceleration of gravity [m/s^2]."""
    signals: dict[Name, SignalField] = Field(default_factory=dict)
    """Functions of time."""
    materials: dict[Name, Material] = Field(default_factory=dict)
    """Materials of beams and shapes."""
    sections: dict[Name, SectionField] = Field(default_factory=dict)
    """Cross-sections of beams."""
    ground: Annotated[GroundEntry, AfterValidator(GroundEntry.resolve)] = GroundEntry()
    """The fixed world."""
    bodies: dict[Name, BodyField]
    """Rigid bodies and beams."""
    joints: dict[Name, Joint] = Field(default_factory=dict)
    """Joints between points of bodies."""
    springs: dict[Name, SpringField] = Field(default_factory=dict)
    """Springs and dampers between points."""
    loads: dict[Name, LoadField] = Field(default_factory=dict)
    """Forces and moments."""
    controllers: dict[Name, ControllerField] = Field(default_factory=dict)
    """Feedback controllers of motors."""
    motors: dict[Name, MotorField] = Field(default_factory=dict)
    """Motors on joints."""
    initial: Initial = Initial()
    """The start."""
    simulation: Simulation = Simulation()
    """Method, accuracy and output."""


_ANNOTATIONS = {key: get_type_hints(ModelFile, include_extras=True)[key] for key in ModelFile.model_fields}

# The keys whose values are parts by name.
FAMILIES = tuple(key for key, annotation in _ANNOTATIONS.items() if get_origin(annotation) is dict)


@cache
def adapter(key: str) -> TypeAdapter[Any]:
    """The validator of a top-level key's value; of one part when the key is a family."""
    return TypeAdapter(get_args(_ANNOTATIONS[key])[1] if key in FAMILIES else _ANNOTATIONS[key])


@cache
def kinds(family: str) -> dict[str, list[str]]:
    """The keys of a family's parts by their `type`; under '' when all have the same."""
    member = get_args(_ANNOTATIONS[family])[1]
    if get_origin(member) is Annotated:
        member = get_args(member)[0]
    found = {}
    for choice in get_args(member) or (member,):
        part = get_args(choice)[0] if get_origin(choice) is Annotated else choice
        if isinstance(part, type) and issubclass(part, Part):
            types = get_args(part.model_fields["type"].annotation) if "type" in part.model_fields else ()
            found[types[0] if len(types) == 1 else ""] = part.key_names()
    return found
