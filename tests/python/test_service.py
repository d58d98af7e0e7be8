"""The judge of the service under load: what it counts, what it asks for, and that its jobs are what they are said to be."""

import math
import sys
import unittest
from pathlib import Path

CASES = Path(__file__).resolve().parents[2] / "cases"
sys.path[:0] = [str(CASES), str(CASES / "service")]
import service as asked  # noqa: E402
import work  # noqa: E402

# Other cases have a case.py too.
sys.modules.pop("case", None)
import case  # noqa: E402

sys.modules.pop("case", None)


def there(seconds=10.0, digests=(["a"], ["b"]), errors=(), states=(0.001,) * 99 + (0.04,), more=5.0):
    """What the service did."""
    return {"seconds": seconds, "cpu": 2 * seconds, "digests": list(digests), "errors": list(errors), "states": list(states), "states_errors": [],
            "memory": [(20.0, 100.0), (20.0 + more, 120.0)]}


HERE = {"seconds": 10.0, "cpu": 20.0, "digests": [["a"], ["b"]], "errors": []}


def lost(result):
    return [bound.figure for bound in case.BOUNDS if not bound.held(result[bound.figure])]


class Judge(unittest.TestCase):
    def test_memory_that_grows_is_told(self):
        self.assertEqual(case.grown([20, 30, 30, 31, 30, 30, 30, 31]), 0)
        self.assertEqual(case.grown([20, 22, 24, 26, 28, 30, 32, 34]), 8)
        self.assertEqual(case.grown([20]), 0)

    def test_what_is_as_good_as_the_program_holds(self):
        result = case.figures(there(), HERE)
        self.assertEqual(lost(result), [])
        self.assertEqual((result["throughput / program"], result["other results"], result["jobs"]), (1.0, 0, 2))
        self.assertAlmostEqual(result["status p50"], 1.0)
        self.assertAlmostEqual(result["status p99"], 40.0)

    def test_each_thing_that_is_not_good_is_lost(self):
        for what, figure in [
            (there(seconds=11.2), "throughput / program"),
            (there(errors=["job 1: failed"]), "errors"),
            (there(digests=(["a"], ["c"])), "other results"),
            (there(states=(0.001,) * 98 + (0.06, 0.06)), "status p99"),
            (there(more=60.0), "memory, more"),
        ]:
            self.assertEqual(lost(case.figures(what, HERE)), [figure])

    def test_a_result_that_neither_has_is_none(self):
        self.assertEqual(case.figures(there(digests=(["a"], None)), {**HERE, "digests": [["a"], None]})["other results"], 1)

    def test_without_an_answer_nothing_is_good(self):
        result = case.figures(there(states=()), HERE)
        self.assertTrue(math.isinf(result["status p99"]))
        self.assertIn("status p99", lost(result))

    def test_quantiles(self):
        values = list(range(100, 0, -1))
        self.assertEqual([case.quantile(values, part) for part in (0.5, 0.99, 1.0)], [51, 100, 100])
        self.assertEqual(case.quantile([7], 0.5), 7)


class Jobs(unittest.TestCase):
    def test_no_two_adaptations_are_the_same(self):
        for cad in (True, False):
            found = work.jobs(200, cad)
            adapted = [job for job in found if job.command == "adapt"]
            self.assertEqual((len(found), len(adapted), len(set(adapted))), (200, 160, 160))
            self.assertEqual(sum(job.command == "inspect" for job in found), 20)
            self.assertEqual(any("--cad" in job.words for job in found), cad)
            self.assertEqual(all(set(job.reads) <= {"start.meshb", "even.meshb", "layer.meshb", work.CAD.name} for job in found), True)

    def test_the_program_adapts_on_one_thread_and_the_service_decides_itself(self):
        for job in work.jobs(10, True):
            self.assertEqual(job.typed()[-3:] == ["--threads", "1", "--deterministic"], job.command == "adapt")
            self.assertNotIn("--threads", job.words)


class Clients(unittest.TestCase):
    def test_a_service_that_is_not_there_is_an_error_and_not_waited_for(self):
        class Nobody:
            def __init__(self, port):
                pass

            def json(self, *_):
                raise asked.Refused("nobody is there")

            def close(self):
                pass

        given, asked.Client = asked.Client, Nobody
        try:
            clients = asked.Clients(1, {"even.meshb": "0"}, [job for job in work.jobs(10, False) if job.command == "inspect"], hash, math.inf)
            clients._client()
        finally:
            asked.Client = given
        self.assertEqual(clients.errors, ["job 0: nobody is there"])


if __name__ == "__main__":
    unittest.main()
