# Told when importing: SPEC is not a Spec(…)
"""The SPEC is a dictionary."""

SPEC = {"stage": "victim"}


def build(data: object) -> None:
    pass
