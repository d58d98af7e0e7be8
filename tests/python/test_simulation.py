"""The forecast for many threads."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "cases"))
from scaling.simulation import lost, row, told  # noqa: E402

LINE = ('simulated {"threads": 4, "sections": {"reading": {"serial": 0.5, "work": 0.0, "span": 0.0, "simulated": 0.5}, '
        '"smoothing": {"serial": 0.0, "work": 4.0, "span": 1.0, "simulated": 1.25}}, '
        '"serial": 0.5, "work": 4.0, "span": 1.0, "one": 4.5, "simulated": 1.75}')


class Simulation(unittest.TestCase):
    def test_the_last_line_of_a_log_counts(self):
        self.assertEqual(told(f"simulated {{}}\nstage\n{LINE}\n")["threads"], 4)
        with self.assertRaises(ValueError):
            told("nothing\n")

    def test_sections_are_told_by_what_they_lose(self):
        self.assertEqual(lost(told(LINE)), [(0.375, "reading"), (0.25, "smoothing")])

    def test_the_speed_up_is_that_against_the_measured_thread(self):
        self.assertIn(" 2.00 ", row(told(LINE), 3.5))


if __name__ == "__main__":
    unittest.main()
