"""An operations researcher's workbench for multi-robot task assignment in search and rescue."""
