"""The forecast for many processes."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "cases"))
from scaling.ranks import Machine, finished, forecast, grown, of_report, on_threads, owners, round_seconds, width  # noqa: E402


def part(work, seconds, vertices, active):
    return {"rank": 0, "work": work, "seconds": seconds, "vertices": vertices, "active": active, "active_tets": 5 * active}


def told(parts, cutting=0.1):
    return {"parts": len(parts), "tets": 6 * sum(part["vertices"] for part in parts), "cutting": cutting, "dealing": 0.2, "of_parts": parts}


def report():
    """Sixteen parts, a zone of two, one of one."""
    rounds = [told([part(1000, 1.0 + at % 2, 1000, 400) for at in range(16)]), told([part(3200, 2.0, 3200, 600)] * 2),
              told([part(1200, 1.0, 1200, 0)])]
    return {
        "threads": 1, "statistics": {"vertices": 15_000, "triangles": 2_000}, "seconds": {"read_and_classify": 0.5, "adapt": 30.0, "total": 32.5},
        "parts": {"rounds": rounds, "numbering": {"outlines": 0.2, "numbers": 0.1, "boundary": 0.3}, "boundary_measured": 0.5,
                  "processes": [{"sent": 0, "waited": 0.0, "worked": 29.0}]},
    }


class Ranks(unittest.TestCase):
    def test_the_heaviest_part_goes_first_to_who_has_the_least(self):
        self.assertEqual(owners([1, 5, 3, 3], 2), [0, 0, 1, 1])
        self.assertEqual(owners([2, 2, 2], 3), [0, 1, 2])

    def test_threads_take_one_part_after_the_other(self):
        self.assertEqual(on_threads([4, 3, 2, 1], 2), 5)
        self.assertEqual(on_threads([], 4), 0)

    def test_one_process_takes_what_it_took(self):
        told = forecast(of_report(report()), Machine(1))
        self.assertAlmostEqual(told["parts"], 24 + 4 + 1)
        self.assertAlmostEqual(told["writing"], 1.5)
        self.assertEqual(told["messages"], 0)

    def test_a_round_takes_as_long_as_its_heaviest_process(self):
        run = of_report(report())
        self.assertAlmostEqual(round_seconds(run.rounds[0], Machine(16))[1], 2.0)
        self.assertAlmostEqual(round_seconds(run.rounds[1], Machine(16))[1], 2.0)
        # Two parts on eight threads have four each.
        machine = Machine(1, 8)
        self.assertAlmostEqual(round_seconds(run.rounds[1], machine)[1], 2.0 / machine.speed(4))

    def test_more_processes_are_faster_until_they_wait(self):
        run = of_report(report())
        seconds = [forecast(run, Machine(ranks))["all"] for ranks in (1, 2, 4, 8, 16)]
        self.assertEqual(seconds, sorted(seconds, reverse=True))
        self.assertGreater(forecast(run, Machine(4096, latency=1e-3))["all"], seconds[-1])

    def test_the_width_of_zones_tells_their_share(self):
        self.assertAlmostEqual(finished(16, 1000, width(report())), 0.6, places=6)
        self.assertGreater(finished(16, 8000, width(report())), 0.75)

    def test_a_larger_mesh_has_more_parts_that_take_as_long(self):
        run = grown(report(), 1e6, 1000, 500)
        main = max(run.rounds, key=lambda round: sum(part[0] for part in round.parts))
        self.assertEqual(len(main.parts), 1000)
        self.assertAlmostEqual(sum(part[1] for part in main.parts) / 1e6, 24 / 16_000)

    def test_reports_of_several_processes_are_refused(self):
        several = report()
        several["parts"]["processes"] *= 2
        with self.assertRaises(ValueError):
            of_report(several)


if __name__ == "__main__":
    unittest.main()
