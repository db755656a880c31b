"""Files of blade rows: profiles, hub and shroud, and their description in TOML."""
