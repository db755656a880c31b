"""Training: one loop for every model. Needs torch; nothing outside training imports it."""
