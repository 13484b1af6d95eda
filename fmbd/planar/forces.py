"""Applied forces: springs, motors with their controllers, loads, gravity; and the inertia forces at zero q''.

(gx, gy, gz)  wrench on a body about its frame's origin, world axes
g_y           forces on the rows of a flexible body, R^T g_y on its modal coordinates
f_eta         forces on the modal coordinates that no row carries
U, i, tau     voltage, current, shaft torque of a motor: La i' = U - Ra i - Ke l',  tau = Km i
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import index, part, part_sums
from fmbd.planar.laws import law
from fmbd.planar.pathways import put_force, put_wrench


@part
def clear_forces(frames: Any, rows: Any) -> None:
    """Start the sums of wrenches and row forces at zero."""
    for i in range(frames.size):
        frame = frames[i]
        frame.gx, frame.gy, frame.gz = 0.0, 0.0, 0.0
    for r in range(rows.size):
        rows[r].g = 0.0


@part
def applied_forces(sys: Any, work: Any, z: np.ndarray, dz: np.ndarray) -> tuple[float, float]:
    """Add springs, motors and loads to the wrenches; fill dz, the rates of the first-order states.

    Returns the power that dampers and friction dissipate and the power of motors and loads [W].
    """
    dissipated, power = 0.0, 0.0
    # springs first, then motors: both are forces along a pathway
    for k in range(sys.springs.size + sys.motors.size):
        if k < sys.springs.size:
            spring = sys.springs[k]
            index = spring.pathway
            path = work.lengths[index]
            force, _, _, _, loss = law(spring, sys.curves, path.value, path.rate)
            dissipated += loss
        else:
            motor = sys.motors[k - sys.springs.size]
            drive = work.drives[k - sys.springs.size]
            index = motor.pathway
            if motor.controller < 0:
                drive.input = work.signal[motor.signal, 0]
            else:
                control = sys.controllers[motor.controller]
                length = work.lengths[control.pathway]
                drive.input = _control(control, length, drive.compensation, work.signal, z, dz)
            force = _motor_torque(motor, drive.input, work.lengths[index].rate, z, dz)
            drive.effort = force
            power += force * work.lengths[index].rate
        put_force(
            sys.pathways[index],
            sys.terms,
            work.geometry,
            sys.stations,
            work.points,
            work.frames,
            work.rows,
            force,
        )
    for k in range(sys.loads.size):
        load = sys.loads[k]
        at = work.points[load.station]
        power += _load(load, sys.stations[load.station], at, work.frames, work.rows, work.signal)
    for k in range(sys.distributed.size):
        load = sys.distributed[k]
        power += _distributed_load(load, work.frames[load.body], work.rows, work.signal)
    return dissipated, power


@part
def _motor_torque(motor: Any, command: float, rate: float, z: np.ndarray, dz: np.ndarray) -> float:
    if motor.electric == 0:
        return command
    if motor.state < 0:
        return motor.Km * (command - motor.Ke * rate) / motor.Ra
    current = z[motor.state]
    dz[motor.state] = (command - motor.Ra * current - motor.Ke * rate) / motor.La
    return motor.Km * current


@part
def _control(
    control: Any, path: Any, compensation: float, signal: np.ndarray, z: np.ndarray, dz: np.ndarray
) -> float:
    """Voltage (or torque) that a controller gives; it may saturate."""
    error = control.shift - path.value
    error_rate = -path.rate
    if control.target >= 0:
        error += control.scale * signal[control.target, 0]
        error_rate += control.scale * signal[control.target, 1]
    wanted = control.bias + control.kp * error + control.kd * error_rate
    if control.feedforward >= 0:
        wanted += signal[control.feedforward, 0]
    if control.online >= 0:
        wanted += control.gravity_gain * compensation
    if control.state >= 0:
        wanted += control.ki * z[control.state]
    given = min(max(wanted, control.low), control.high)
    if control.state >= 0:
        # a saturated controller stops integrating the error that drives it further out
        frozen = (wanted - given) * error * control.ki > 0.0
        dz[control.state] = 0.0 if frozen else error
    return given


@part
def _load(load: Any, station: Any, at: Any, frames: Any, rows: Any, signal: np.ndarray) -> float:
    """Force and moment at a station; returns their power."""
    fx = signal[load.fx, 0] if load.fx >= 0 else 0.0
    fy = signal[load.fy, 0] if load.fy >= 0 else 0.0
    moment = signal[load.moment, 0] if load.moment >= 0 else 0.0
    if load.following == 1:
        c, s = np.cos(at.angle), np.sin(at.angle)
        fx, fy = c * fx - s * fy, s * fx + c * fy
    put_wrench(station, at, frames, rows, fx, fy, moment)
    return fx * at.vx + fy * at.vy + moment * at.w


@part
def _distributed_load(load: Any, frame: Any, rows: Any, signal: np.ndarray) -> float:
    """Uniform load on a stretch of a beam: int (1, x, S) dx = (length, moment, row); returns its power."""
    c, s, row = frame.c, frame.s, rows[load.row]
    qx, qy = signal[load.fx, 0], signal[load.fy, 0]
    if load.following == 0:
        qx, qy = c * qx + s * qy, c * qy - s * qx
    fx, fy = (c * qx - s * qy) * load.length, (s * qx + c * qy) * load.length
    moment = load.moment * qy - row.value * qx
    frame.gx += fx
    frame.gy += fy
    row.g += qy
    power = fx * frame.vx + fy * frame.vy + qy * row.rate
    if load.row_u >= 0:
        along = rows[load.row_u]
        moment += along.value * qy
        along.g += qx
        power += qx * along.rate
    frame.gz += moment
    return power + moment * frame.w


@part
def body_forces(sys: Any, work: Any, q: np.ndarray, v: np.ndarray) -> float:
    """Add gravity, the inertia forces at zero q'', stiffness and damping of the beams.

    Returns the power that the beams' damping dissipates [W]. Per body, with S1 = (mx, my) the first moment and J the
    moment of inertia as it is deformed, a = b - gravity, all in the body's axes:
        F = -m a - bw x S1 + w^2 S1 - S1'' - 2 w x S1',    M = -S1 x a - J bw - J' w
        f_eta = -s (ey.a) - p bw + (w^2 - omega^2) eta - d eta'
    With foreshortening, rows n = dU/deta and k = dX/deta that bend add -n (ex.a) + k w^2 to f_eta.
    """
    dissipated = 0.0
    gx, gy = sys.gravity[0], sys.gravity[1]
    for i in range(sys.bodies.size):
        b = sys.bodies[i]
        f = work.frames[i]
        c, s, w, bw = f.c, f.s, f.w, f.bw
        ax, ay = f.bx - gx, f.by - gy
        if b.nf > 0:
            dissipated += _modal_forces(b, w, sys.omega2, sys.modal_damping, q, v, work.f_eta)
            work.rows[b.row0].g -= c * ay - s * ax
            work.rows[b.row0 + 1].g -= bw
            if b.axial >= 0:
                work.rows[b.axial].g -= c * ax + s * ay
                work.rows[b.axial + 1].g += w * w
        sx, sy = c * f.mx - s * f.my, s * f.mx + c * f.my
        fx, fy = 2.0 * w * f.dmy - f.ddmx, -2.0 * w * f.dmx
        f.gx += -b.mass * ax + bw * sy + w * w * sx + c * fx - s * fy
        f.gy += -b.mass * ay - bw * sx + w * w * sy + s * fx + c * fy
        f.gz += -(sx * ay - sy * ax) - f.J * bw - 2.0 * w * f.spin
    for k in range(sys.inertias.size):
        point = sys.inertias[k]
        row = work.rows[point.row]
        row.g -= work.frames[point.body].w ** 2 * point.value * row.value
    return dissipated


@part_sums
def _modal_forces(
    b: Any,
    w: float,
    omega2: np.ndarray,
    damping: np.ndarray,
    q: np.ndarray,
    v: np.ndarray,
    f_eta: np.ndarray,
) -> float:
    """Centrifugal, elastic and damping forces on each mode; returns the power dissipated."""
    loss = 0.0
    first, mode0 = index(b.first_q), index(b.mode0)
    for k in range(index(b.nf)):
        eta, rate = q[first + k], v[first + k]
        d = damping[mode0 + k]
        f_eta[mode0 + k] = (w * w - omega2[mode0 + k]) * eta - d * rate
        loss += d * rate * rate
    return loss
