"""The functions that the commands are named after."""
