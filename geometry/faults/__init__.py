"""Models with faults that `bootstrap --heal` mends; write_all.py writes their files here."""
