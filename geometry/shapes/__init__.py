"""What geometry files hold: airfoils, outlines, bodies in domains; each is sampled into a boundary."""
