"""The command line as ``python -m msmrta_opt``, of the environment whose Python this is."""

from .cli import main

if __name__ == "__main__":
    main()
