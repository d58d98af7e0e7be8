//! Starting configurations, with comments.

/// Kinds of solvers with a configuration to begin with.
pub const ALL: [(&str, &str); 4] = [
    ("analytic", include_str!("examples/analytic.toml")),
    ("command", include_str!("examples/command.toml")),
    ("su2", include_str!("examples/su2.toml")),
    ("openfoam", include_str!("examples/openfoam.toml")),
];

/// The configuration of a kind.
pub fn of(kind: &str) -> Option<&'static str> {
    ALL.iter().find(|(name, _)| *name == kind).map(|(_, text)| *text)
}

#[cfg(test)]
mod tests {
    #[test]
    fn examples_can_be_read() {
        for (kind, text) in super::ALL {
            let config = super::super::parse(text).unwrap_or_else(|error| panic!("{kind}: {error}"));
            let chosen = serde_json::to_value(&config.solver).unwrap();
            assert!(chosen.get(kind).is_some(), "{kind}: {chosen}");
        }
    }
}
