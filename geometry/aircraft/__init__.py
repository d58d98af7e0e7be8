"""Aircraft; write_all.py writes their files here."""
