"""Figures of runs: what they show (charts), and how Matplotlib draws it."""
