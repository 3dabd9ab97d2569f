"""One page that holds a run and the core that made it; the sources of the page stand beside."""
