"""Cases and runs as files: TOML and npz."""
