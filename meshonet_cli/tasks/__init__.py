"""What commands do to one input of many: how it is read, what is made of it, where that goes."""
