//! From names of fields to numbers of values.
use super::solver::{FieldName, kind_of};
use std::collections::BTreeMap;

/// The values of a solution that are asked for, as `field pick --take` has them: `U:x` its number, `U:norm` norm:2-4.
pub fn picked(wanted: &[String], fields: &[FieldName]) -> Result<String, String> {
    let mut first = BTreeMap::new();
    let mut next = 1;
    for field in fields {
        first.entry(field.name.as_str()).or_insert((next, field.values));
        next += field.values;
    }
    let known = || fields.iter().map(|field| field.name.clone()).collect::<Vec<_>>().join(", ");
    if wanted.is_empty() {
        let scalars =
            fields.iter().filter(|field| field.values == 1).map(|field| first[field.name.as_str()].0.to_string());
        let scalars: Vec<String> = scalars.collect();
        let remedy = "name some in [metric] fields, of a vector U a component \"U:x\" or its length \"U:norm\"";
        return if scalars.is_empty() {
            Err(format!("no field is a scalar ({}): {remedy}", known()))
        } else {
            Ok(scalars.join(","))
        };
    }
    let one = |word: &String| {
        let (name, part) = word.rsplit_once(':').map_or((word.as_str(), None), |(name, part)| (name, Some(part)));
        let Some(&(from, values)) = first.get(name) else {
            return Err(format!("[metric] fields: the solver has no field '{name}'; there are {}", known()));
        };
        let number = match part {
            None if values == 1 => return Ok(from.to_string()),
            Some("norm") => return Ok(format!("norm:{from}-{}", from + values - 1)),
            Some("x") if values == 3 => Some(1),
            Some("y") if values == 3 => Some(2),
            Some("z") if values == 3 => Some(3),
            Some(part) => part.parse().ok().filter(|number| (1..=values).contains(number)),
            None => None,
        };
        let kind = kind_of(values);
        number.map(|number: usize| (from + number - 1).to_string()).ok_or_else(|| {
            format!("[metric] fields: '{word}': {name} has {values} values a vertex ({kind:?}); give \"{name}:norm\", or one of them, \"{name}:1\" to \"{name}:{values}\"")
        })
    };
    let all: Result<Vec<String>, String> = wanted.iter().map(one).collect();
    Ok(all?.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_picked_by_name() {
        let field = |name: &str, values| FieldName { name: name.into(), values };
        let fields = [field("p", 1), field("U", 3), field("T", 1)];
        let take = |words: &[&str]| picked(&words.iter().map(|&word| word.into()).collect::<Vec<_>>(), &fields);
        assert_eq!(take(&[]).unwrap(), "1,5");
        assert_eq!(take(&["T", "U:norm", "U:z", "U:1"]).unwrap(), "5,norm:2-4,4,2");
        assert!(take(&["q"]).unwrap_err().contains("'q'; there are p, U, T"));
        assert!(take(&["U"]).unwrap_err().contains("U:norm"));
        assert!(take(&["U:4"]).unwrap_err().contains("U:3"));
        assert!(picked(&[], &fields[1..2]).unwrap_err().contains("no field is a scalar"));
    }
}
