"""The archive of a run, its drawing for ParaView, and what is computed from it."""
