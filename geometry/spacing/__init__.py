"""Where nodes go along a curve: spacing laws, size fields, first cells."""
