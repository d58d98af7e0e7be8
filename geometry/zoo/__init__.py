"""Families of models; write_all.py writes their files here."""
