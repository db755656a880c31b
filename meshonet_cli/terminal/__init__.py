"""What a user sees while a command runs: lines, errors, progress; and interrupts."""
