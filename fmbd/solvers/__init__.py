"""Time integration: one file per method, a shared compiled loop."""
