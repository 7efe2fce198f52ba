"""How one walks: :mod:`.motion` of the body, :mod:`.geodesics` (exact distances and paths), the :mod:`.follower` of a path."""
