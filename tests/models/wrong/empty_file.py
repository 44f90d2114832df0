# Told when importing: not a formulation: it has no SPEC and no build(data)
