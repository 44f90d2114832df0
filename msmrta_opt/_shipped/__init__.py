"""What a wheel carries besides code: the checkout's ``models/`` and ``instances/``."""
