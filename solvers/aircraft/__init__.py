"""Surfaces of aircraft: patches of body and wing that match at the junction."""
