"""Tasks of commands for one input of many: how it is read, processed and written."""
