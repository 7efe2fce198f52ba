"""GN-Bench's buildings of Gaussian splats, drawn by its own simulator behind the bridge; ways are measured here."""
