"""One page of HTML about a run that needs nothing else: no network, no server, no other file."""
