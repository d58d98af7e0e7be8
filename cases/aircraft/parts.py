"""Which part of the transport aircraft a face belongs to, by where it is (geometry/aircraft/transport.py: x aft, y to the tip, z up; metres)."""

# The first box that holds a face's whole extent has it: least and greatest x, y, z.
ALL = (-100, 100)
BOXES = {
    "nacelle": ((11.4, 15.6), (3.9, 6.5), (-3.6, -1.2)),
    "pylon": ((12.3, 16.7), (4.8, 5.6), (-1.9, -0.2)),
    "fin": ((24.5, 36.1), (-0.1, 0.6), (1.15, 8.1)),
    "tailplane": ((30.9, 36.1), (0.1, 6.1), (0.6, 1.7)),
    "wing": ((12.4, 22.6), (0.5, 17.1), (-2.3, 1.8)),
    "fuselage": (ALL, ALL, ALL),
}
# The plane side, which is no part: a far field is cut off there.
PLANE = 1e-6


def of_faces(faces):
    """{part: numbers of faces} of faces as `geo-adapt model --json` lists them."""
    found = {name: [] for name in BOXES}
    for face in faces:
        low, high = face["bounds"]
        if high[1] < PLANE:
            continue
        inside = (name for name, box in BOXES.items() if all(a <= x and y <= b for (a, b), x, y in zip(box, low, high, strict=True)))
        found[next(inside)].append(face["number"])
    return found
