"""Many runs of one scene at once."""
