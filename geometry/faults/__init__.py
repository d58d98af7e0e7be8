"""Models with faults that `bootstrap` mends, some of them with `--heal`; write_all.py writes their files here."""
