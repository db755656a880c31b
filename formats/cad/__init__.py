"""CAD files, STEP and B-rep, read by Open Cascade (extra ``cad``)."""
