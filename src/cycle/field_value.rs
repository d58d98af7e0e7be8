//! From names of fields to values of a vertex.
use super::data::{FieldName, GoalFlow, kind_of};
use std::fmt;

/// What of the values of a vertex, which are counted from 1 through all fields; as text as `field pick --take` has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Value {
    /// One of them.
    One(usize),
    /// The root of the sum of the squares, from the first to the last.
    Norm(usize, usize),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One(number) => number.fmt(f),
            Self::Norm(first, last) => write!(f, "norm:{first}-{last}"),
        }
    }
}

impl Value {
    /// Of all values of a vertex.
    pub fn of(self, values: &[f64]) -> f64 {
        match self {
            Self::One(number) => values[number - 1],
            Self::Norm(first, last) => values[first - 1..last].iter().map(|x| x * x).sum::<f64>().sqrt(),
        }
    }

    /// What a word means: `p`, `U:x`, `U:2`, `U:norm`.
    ///
    /// # Errors
    /// When there is no such field, or it has no such part.
    pub fn find(word: &str, fields: &[FieldName]) -> Result<Self, String> {
        let (name, part) = word.rsplit_once(':').map_or((word, None), |(name, part)| (name, Some(part)));
        let mut first = 1;
        for field in fields {
            if field.name == name {
                return Self::part(part, first, field).ok_or_else(|| {
                    let values = field.values;
                    let kind = kind_of(values).map_or_else(String::new, |kind| format!(" ({kind:?})"));
                    format!(
                        "'{word}': {name} has {values} values a vertex{kind}; give \"{name}:norm\", or one of them, \"{name}:1\" to \"{name}:{values}\""
                    )
                });
            }
            first += field.values;
        }
        Err(format!("the solver has no field '{name}'; there are {}", known(fields)))
    }

    fn part(part: Option<&str>, first: usize, field: &FieldName) -> Option<Self> {
        let number = match part {
            None if field.values == 1 => 1,
            Some("norm") => return Some(Self::Norm(first, first + field.values - 1)),
            Some("x") if field.values == 3 => 1,
            Some("y") if field.values == 3 => 2,
            Some("z") if field.values == 3 => 3,
            Some(part) => part.parse().ok().filter(|number| (1..=field.values).contains(number))?,
            None => return None,
        };
        Some(Self::One(first + number - 1))
    }
}

/// All values of the named fields, one after the other; a word may name a component, as [`Value::find`] has it.
///
/// # Errors
/// When there is no such field.
fn all_values(words: &[String], fields: &[FieldName]) -> Result<Vec<Value>, String> {
    let mut found = Vec::new();
    for word in words {
        match fields.iter().position(|field| field.name == *word) {
            Some(at) => {
                let first = 1 + fields[..at].iter().map(|field| field.values).sum::<usize>();
                found.extend((first..first + fields[at].values).map(Value::One));
            }
            None => found.push(Value::find(word, fields)?),
        }
    }
    Ok(found)
}

/// The values of state and adjoint of a flow.
///
/// # Errors
/// When the solver has no such field.
pub fn flow_values(flow: &GoalFlow, fields: &[FieldName]) -> Result<[Vec<Value>; 2], String> {
    let all = |words: &Vec<String>| all_values(words, fields).map_err(|error| format!("[goal] flow: {error}"));
    Ok([all(&flow.primal)?, all(&flow.adjoint)?])
}

fn known(fields: &[FieldName]) -> String {
    fields.iter().map(|field| field.name.as_str()).collect::<Vec<_>>().join(", ")
}

/// The values that a metric is made from: those that are named, or all scalars.
///
/// # Errors
/// As [`Value::find`]; when nothing is named and nothing is a scalar.
pub fn values_of(wanted: &[String], fields: &[FieldName]) -> Result<Vec<Value>, String> {
    if !wanted.is_empty() {
        let found = wanted.iter().map(|word| Value::find(word, fields));
        return found.collect::<Result<_, _>>().map_err(|error| format!("[metric] fields: {error}"));
    }
    let scalars: Vec<Value> = fields
        .iter()
        .filter(|field| field.values == 1)
        .filter_map(|field| Value::find(&field.name, fields).ok())
        .collect();
    let remedy = "name some in [metric] fields, of a vector U a component \"U:x\" or its length \"U:norm\"";
    if scalars.is_empty() { Err(format!("no field is a scalar ({}): {remedy}", known(fields))) } else { Ok(scalars) }
}

/// As `field pick --take` has them.
pub fn as_words(values: &[Value]) -> String {
    values.iter().map(Value::to_string).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_picked_by_name() {
        let field = |name: &str, values| FieldName { name: name.into(), values };
        let fields = [field("p", 1), field("U", 3), field("T", 1)];
        let words = |words: &[&str]| words.iter().map(|&word| word.into()).collect::<Vec<String>>();
        let take = |names: &[&str]| values_of(&words(names), &fields).map(|values| as_words(&values));
        assert_eq!(take(&[]).unwrap(), "1,5");
        assert_eq!(take(&["T", "U:norm", "U:z", "U:1"]).unwrap(), "5,norm:2-4,4,2");
        assert!(take(&["q"]).unwrap_err().contains("'q'; there are p, U, T"));
        assert!(take(&["U"]).unwrap_err().contains("U:norm"));
        assert!(take(&["U:4"]).unwrap_err().contains("U:3"));
        assert_eq!(Value::find("U:norm", &fields).unwrap().of(&[9.0, 1.0, 2.0, 2.0, 7.0]), 3.0);
        assert_eq!(Value::find("T", &fields).unwrap().of(&[9.0, 1.0, 2.0, 2.0, 7.0]), 7.0);
        let all = |names: &[&str]| all_values(&words(names), &fields).map(|values| as_words(&values));
        assert_eq!(all(&["T", "U", "U:y", "p"]).unwrap(), "5,2,3,4,3,1");
        assert!(all(&["q"]).unwrap_err().contains("'q'; there are p, U, T"));
        assert!(values_of(&[], &fields[1..2]).unwrap_err().contains("no field is a scalar"));
    }
}
