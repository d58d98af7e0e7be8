"""The half y >= 0 of transport.py's aircraft: its plane side in y = 0 is one face."""

import step
import transport


def build():
    """Metres; the skin of the half with the plane side."""
    return transport.half()


if __name__ == "__main__":
    step.main(build, "transport-half")
