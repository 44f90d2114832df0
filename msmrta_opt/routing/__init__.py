"""The joint problem: who serves what and in which order, over open routes; improved and bounded."""
