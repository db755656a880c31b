"""Files of blade rows: profiles, hub and shroud, and what TOML says of them."""
