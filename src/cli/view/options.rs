//! How a scene is to look, from the arguments.
use super::Arguments;
use super::look::CutStyle;
use crate::cli::metric::common::Failure;
use crate::geometry::called;
use crate::view::Scene;
use crate::view::cut::{Part, Style};
use crate::view::picture::{Colour, Options};
use std::collections::BTreeSet;

/// What surrounds a body in a flow: hidden where nothing else is said, else the picture would show the box and not the body.
const AROUND: [&str; 2] = ["farfield", "symmetry"];

/// Lines of equal value on a cut along the plane.
const ISOLINES: u32 = 20;

impl Arguments {
    /// How it is to look.
    pub(super) fn options(&self, scene: &Scene<'_>) -> Result<Options, Failure> {
        let look = &self.look;
        let is_model = scene.given.model.is_some();
        if look.below.is_some() && scene.mesh.tets.is_empty() {
            return Err(format!("{}: --below: there are no tetrahedra", self.mesh.display()).into());
        }
        if look.streamlines.is_some() && (scene.given.velocity.is_none() || scene.mesh.tets.is_empty()) {
            let message =
                "there is no velocity in tetrahedra to follow; give a --field that is a vector of three components";
            return Err(format!("{}: --streamlines: {message}", self.mesh.display()).into());
        }
        let below = look.below.map(|below| below as f32);
        let mut part = Part { plane: look.cut, style: Style::Tets, hidden: self.hidden(scene)?, below };
        let colour = self.colour(scene, &part)?;
        part.style = match look.cut_style {
            Some(CutStyle::Plane) => Style::Plane,
            Some(CutStyle::Tets) => Style::Tets,
            None if matches!(colour, Colour::Field(_)) || is_model => Style::Plane,
            None => Style::Tets,
        };
        let is_section = part.plane.is_some() && part.style == Style::Plane;
        Ok(Options {
            size: look.size,
            view: look.view.map(|view| view.0),
            at: look.at.map(|at| at.0),
            zoom: look.zoom,
            colour,
            isolines: look.isolines.unwrap_or(if is_section { ISOLINES } else { 0 }),
            streamlines: look.streamlines.unwrap_or(0),
            part,
            range: look.range.map(|range| range.0),
            wire: !look.no_wire && !is_model,
            numbers: look.numbers.unwrap_or(is_model),
        })
    }

    /// The surfaces that are hidden, by reference.
    fn hidden(&self, scene: &Scene<'_>) -> Result<BTreeSet<i32>, Failure> {
        let names = &scene.given.names.triangles;
        let there = |reference: &i32| scene.surfaces.iter().any(|known| known.reference == *reference);
        let find = |what: &str| -> Vec<i32> {
            let number = what.parse().ok().filter(there);
            let named = called(names, what).into_iter().filter(there);
            named.chain(number).collect()
        };
        let mut hidden = BTreeSet::new();
        if self.look.hide.is_empty() {
            let around: BTreeSet<i32> = AROUND.iter().flat_map(|name| find(name)).collect();
            let is_flow = !find(AROUND[0]).is_empty() && around.len() < scene.surfaces.len();
            if is_flow {
                self.run.note(&["the far field is hidden; --hide none shows it".to_string()]);
                hidden = around;
            }
        }
        for what in self.look.hide.iter().filter(|what| *what != "none") {
            let found = find(what);
            if found.is_empty() {
                let called = |name: &Option<String>| name.as_ref().map_or(String::new(), |name| format!(" ({name})"));
                let known = scene.surfaces.iter().take(20).map(|one| format!("{}{}", one.reference, called(&one.name)));
                let (name, known) = (self.mesh.display(), known.collect::<Vec<_>>().join(", "));
                let is_number = what.parse::<i32>().is_ok();
                let said = if is_number { "has the reference" } else { "is called" };
                return Err(format!("{name}: --hide: no triangle {said} {what}; there are {known}").into());
            }
            hidden.extend(found);
        }
        Ok(hidden)
    }

    fn colour(&self, scene: &Scene<'_>, part: &Part) -> Result<Colour, Failure> {
        let fields = &scene.given.fields;
        let Some(by) = &self.look.color else {
            let measured =
                self.metric.as_ref().is_some_and(|path| path.as_os_str() != "none") || self.analytic.is_some();
            let is_inside = !scene.mesh.tets.is_empty() && (part.plane.is_some() || part.below.is_some());
            return Ok(if !self.field.is_empty() {
                Colour::Field(0)
            } else if is_inside || measured {
                Colour::Quality
            } else {
                Colour::Reference
            });
        };
        match by.as_str() {
            "reference" => return Ok(Colour::Reference),
            "quality" => return Ok(Colour::Quality),
            "field" if !self.field.is_empty() => return Ok(Colour::Field(0)),
            _ => {}
        }
        // The length of a vector is found by the vector's name too.
        let is_called =
            |name: &str| name == by || name.strip_prefix('|').and_then(|name| name.strip_suffix('|')) == Some(by);
        if let Some(number) = fields.iter().position(|field| is_called(&field.name)) {
            return Ok(Colour::Field(number));
        }
        let names = ["reference", "quality"].into_iter().chain(fields.iter().map(|field| field.name.as_str()));
        let names = names.collect::<Vec<_>>().join(", ");
        let remedy = match by.as_str() {
            "field" => "; give a --field",
            "distance" => "; give a --cad",
            "size" | "aspect" => "; give a --metric",
            _ => "",
        };
        Err(format!("--color: nothing is called '{by}'{remedy}; there are {names}").into())
    }
}
