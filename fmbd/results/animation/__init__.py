"""Moving pictures of a run, drawn off-screen."""
