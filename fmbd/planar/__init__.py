"""Compiled kernels of planar mechanisms: kinematics, forces, the articulated-body recursion."""
