"""The quad mesh of a seamless map."""
