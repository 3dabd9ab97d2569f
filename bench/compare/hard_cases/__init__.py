"""Hard cases, run by pendcore and its peers: a file per case, a function per contender."""
