"""The paper's six families of boundaries, each with one parameter; and random airfoils to train on."""
