//! The words of the configuration for our own subcommands.
use super::Config;

impl Config {
    /// The options of `geo-adapt adapt`, files apart, for an adaptation to this complexity; on a model, or without.
    pub fn adapt_words(&self, complexity: f64, has_model: bool) -> Vec<String> {
        let metric = &self.metric;
        let mut words = vec!["--complexity".into(), complexity.to_string()];
        option(&mut words, "--norm", metric.norm.as_ref());
        option(&mut words, "--hessian", metric.hessian.map(|word| word.name()).as_ref());
        option(&mut words, "--gradation", metric.gradation.as_ref());
        option(&mut words, "--hmin", metric.hmin.as_ref());
        option(&mut words, "--hmax", metric.hmax.as_ref());
        option(&mut words, "--aspect-ratio", metric.aspect_ratio.as_ref());
        if !metric.local.is_empty() {
            words.extend(["--local".into(), metric.local.join(",")]);
        }
        for wall in &metric.walls {
            option(&mut words, "--wall", Some(wall));
        }
        if has_model && metric.geometry == Some(false) {
            words.push("--no-geometry".into());
        }
        option(&mut words, "--segments", metric.segments.as_ref());
        option(&mut words, "--feature-cells", metric.feature_cells.as_ref());
        option(&mut words, "--memory", self.adapt.memory.as_ref());
        words.extend(self.adapt.options.iter().cloned());
        words
    }

    /// The options of `geo-adapt bootstrap`, files apart.
    pub fn bootstrap_words(&self) -> Vec<String> {
        let mut words = Vec::new();
        option(&mut words, "--far-field", self.mesh.far_field.as_ref());
        option(&mut words, "--symmetry", self.mesh.symmetry.as_ref());
        words.extend(self.mesh.options.iter().cloned());
        words
    }
}

/// Adds an option with its value, if there is one.
pub fn option(words: &mut Vec<String>, name: &str, value: Option<&impl ToString>) {
    if let Some(value) = value {
        // In one word, so that a value may begin with a dash.
        words.push(format!("{name}={}", value.to_string()));
    }
}
