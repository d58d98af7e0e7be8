"""The case of the aircraft: which part a face belongs to."""

import sys
import unittest
from pathlib import Path

CASES = Path(__file__).resolve().parents[2] / "cases"
sys.path.insert(0, str(CASES / "aircraft"))
import parts  # noqa: E402


def face(number, low, high):
    return {"number": number, "bounds": [low, high]}


class Parts(unittest.TestCase):
    def test_faces_go_to_the_part_whose_box_holds_them(self):
        faces = [
            face(1, [0, 0, -2], [36, 0, 8]),  # the plane side: no part
            face(2, [0, 0, -1.5], [2, 1.4, -0.5]), face(3, [15.3, 5.6, -1], [22, 16, 0.3]), face(4, [11.5, 4.3, -3.2], [12.1, 5.2, -1.4]),
            face(5, [24.6, 0, 1.2], [34, 0.4, 2.8]), face(6, [31, 0.2, 0.8], [36, 5.5, 1.5]), face(7, [12.4, 5.0, -1.5], [16.6, 5.4, -0.8]),
        ]
        found = parts.of_faces(faces)
        self.assertEqual(found, {"nacelle": [4], "pylon": [7], "fin": [5], "tailplane": [6], "wing": [3], "fuselage": [2]})


if __name__ == "__main__":
    unittest.main()
