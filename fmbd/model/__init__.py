"""The model file and the objects that loading it gives."""

from fmbd.errors import ModelError
from fmbd.model.beam import Beam, Damping, PointMass
from fmbd.model.controllers import GravityCompensation, PDController, PIDController, Placement
from fmbd.model.expressions import compile_time_expression
from fmbd.model.initial import Initial
from fmbd.model.joints import Joint, JointSpring
from fmbd.model.laws import Backlash, ForceTable, Friction, Limits
from fmbd.model.loader import load_model, load_model_text
from fmbd.model.loads import DistributedLoad, ForceLoad, MomentLoad
from fmbd.model.materials import Material
from fmbd.model.model import Model
from fmbd.model.motors import ControllerRef, DCMotor, TorqueMotor, Transmission
from fmbd.model.pieces import BeamPiece
from fmbd.model.points import Ground, Point, PointRef
from fmbd.model.rigid import RigidBody
from fmbd.model.shapes import Box, Disc, Rod
from fmbd.model.signals import Constant, Pulse, Ramp, Signal, Sine, SmoothStep, Step, TimeExpression
from fmbd.model.simulation import Baumgarte, Simulation
from fmbd.model.springs import PointToPointSpring, TorsionalSpring
from fmbd.model.tables import Table

__all__ = [
    "Backlash",
    "Baumgarte",
    "Beam",
    "BeamPiece",
    "Box",
    "Constant",
    "ControllerRef",
    "DCMotor",
    "Damping",
    "Disc",
    "DistributedLoad",
    "ForceLoad",
    "ForceTable",
    "Friction",
    "GravityCompensation",
    "Ground",
    "Initial",
    "Joint",
    "JointSpring",
    "Limits",
    "Material",
    "Model",
    "ModelError",
    "MomentLoad",
    "PDController",
    "PIDController",
    "Placement",
    "Point",
    "PointMass",
    "PointRef",
    "PointToPointSpring",
    "Pulse",
    "Ramp",
    "RigidBody",
    "Rod",
    "Signal",
    "Simulation",
    "Sine",
    "SmoothStep",
    "Step",
    "Table",
    "TimeExpression",
    "TorqueMotor",
    "TorsionalSpring",
    "Transmission",
    "compile_time_expression",
    "load_model",
    "load_model_text",
]
