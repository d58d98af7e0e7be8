"""The independent judge: its own reader and its own formulas (METHOD.md §1), sharing nothing with the Rust code."""
