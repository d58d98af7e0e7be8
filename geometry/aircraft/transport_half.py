"""The half y >= 0 of transport.py's aircraft: its plane side in y = 0 is one face."""

from aircraft import transport


def build():
    """Metres; the skin of the half with the plane side."""
    return transport.half()
