"""Where one may stand: :mod:`.footprints` of what is in the way, :mod:`.walkable` ground, :mod:`.placement` that keeps it so."""
