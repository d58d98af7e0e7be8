//! Counts for whoever looks after the service, as Prometheus reads them.
use super::Shared;
use crate::serve::catalogue::State;
use axum::extract::{MatchedPath, Request, State as Of};
use axum::middleware::Next;
use axum::response::Response;
use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::{Histogram, exponential_buckets};
use prometheus_client::registry::Registry;
use std::sync::Mutex;
use std::time::Instant;

#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
struct Asked {
    method: String,
    route: String,
    status: u16,
}

#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
struct Of1 {
    state: String,
}

/// The counts.
pub struct Figures {
    registry: Mutex<Registry>,
    requests: Family<Asked, Counter>,
    seconds: Histogram,
    jobs: Family<Of1, Counter>,
    job_seconds: Histogram,
    now: Family<Of1, Gauge>,
    models: Gauge,
    model_bytes: Gauge,
}

impl Default for Figures {
    fn default() -> Self {
        let mut registry = Registry::with_prefix("geo_adapt");
        let (requests, jobs, now) = (Family::default(), Family::default(), Family::default());
        let seconds = Histogram::new(exponential_buckets(0.001, 4.0, 9));
        let job_seconds = Histogram::new(exponential_buckets(0.01, 4.0, 12));
        let (models, model_bytes) = (Gauge::default(), Gauge::default());
        registry.register("requests", "Requests by route and status", Family::clone(&requests));
        registry.register("request_seconds", "Time until the answer begins", seconds.clone());
        registry.register("jobs_ended", "Jobs that have ended", Family::clone(&jobs));
        registry.register("job_seconds", "Time that jobs were at work", job_seconds.clone());
        registry.register("jobs_now", "Jobs that wait or are at work", Family::clone(&now));
        registry.register("models", "Models in memory", models.clone());
        registry.register("model_bytes", "Memory of these models", model_bytes.clone());
        Self { registry: Mutex::new(registry), requests, seconds, jobs, job_seconds, now, models, model_bytes }
    }
}

impl Figures {
    /// A job has ended.
    pub fn ended(&self, state: State, seconds: f64) {
        self.jobs.get_or_create(&Of1 { state: state.name().into() }).inc();
        self.job_seconds.observe(seconds);
    }

    /// As text.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn text(&self, service: &Shared) -> Result<String, sqlx::Error> {
        for state in [State::Queued, State::Running] {
            let count = service.catalogue.count_jobs(None, [state, state]).await?;
            self.now.get_or_create(&Of1 { state: state.name().into() }).set(count as i64);
        }
        if let Some(shop) = service.shop() {
            let (models, bytes) = shop.models();
            self.models.set(models as i64);
            self.model_bytes.set(bytes as i64);
        }
        let mut text = String::new();
        let registry = self.registry.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        // Writing to a String does not fail.
        let _ = encode(&mut text, &registry);
        Ok(text)
    }
}

/// Counts a request.
pub async fn count(Of(service): Of<Shared>, request: Request, next: Next) -> Response {
    let began = Instant::now();
    let route = request.extensions().get::<MatchedPath>().map_or("none", MatchedPath::as_str).to_owned();
    // Methods of clients are as many as they like.
    let known = ["GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"];
    let method = known.into_iter().find(|name| request.method() == name).unwrap_or("other").to_owned();
    let response = next.run(request).await;
    let seconds = began.elapsed().as_secs_f64();
    let status = response.status().as_u16();
    tracing::debug!(target: "requests", method, route, status, seconds, "asked");
    service.figures.requests.get_or_create(&Asked { method, route, status }).inc();
    service.figures.seconds.observe(seconds);
    response
}
