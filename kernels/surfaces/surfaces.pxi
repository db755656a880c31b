# Surfaces of many patches, and volumes marched from them.
