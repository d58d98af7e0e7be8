//! What clients see: HTTP and JSON, under /v1.
mod about;
mod caller;
mod download;
mod error;
mod events;
mod figures;
mod files;
mod jobs;
mod page;
mod uploads;

use super::Error;
use super::blobs::Blobs;
use super::catalogue::Catalogue;
use super::commands::Commands;
use super::settings::{Settings, Tls};
use super::work::{Hub, Shop};
use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::{HeaderName, HeaderValue, header};
use axum_server::tls_rustls::RustlsConfig;
use caller::Callers;
use figures::Figures;
use std::net::SocketAddr;
use std::path::Path;
use std::sync::{Arc, OnceLock, Weak};
use std::time::Duration;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::set_header::SetResponseHeaderLayer;
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Most bytes of a body that is JSON.
const MOST_JSON: usize = 1 << 20;

/// How long requests that are under way may take when the service ends.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long a client may take for the head of a request.
const HEAD: Duration = Duration::from_secs(20);

/// What requests share.
pub struct Service {
    /// What the operator decides.
    pub settings: Settings,
    /// What may be asked for.
    pub commands: Commands,
    /// The database.
    pub catalogue: Catalogue,
    /// The contents.
    pub blobs: Blobs,
    /// Who watches what.
    pub hub: Hub,
    /// Counts for whoever looks after the service.
    pub figures: Figures,
    callers: Callers,
    shop: OnceLock<Weak<Shop>>,
}

/// The service, as handlers have it.
pub type Shared = Arc<Service>;

impl Service {
    /// Of its parts.
    pub fn new(settings: Settings, commands: Commands, catalogue: Catalogue, blobs: Blobs) -> Self {
        let callers = Callers::new(settings.limits.rate);
        let (hub, figures, shop) = (Hub::default(), Figures::default(), OnceLock::new());
        Self { settings, commands, catalogue, blobs, hub, figures, callers, shop }
    }

    /// Its worker is there.
    pub fn set_shop(&self, shop: Weak<Shop>) {
        let _ = self.shop.set(shop);
    }

    /// Its worker.
    pub fn shop(&self) -> Option<Arc<Shop>> {
        self.shop.get()?.upgrade()
    }

    /// Removes what nobody will ask for: uploads that were given up.
    pub async fn sweep(&self) {
        uploads::sweep(&self.settings).await;
    }

    /// Forgets contents that nobody has any more.
    pub async fn forget(&self, id: &str) {
        if matches!(self.catalogue.is_forgotten(id).await, Ok(true)) {
            self.blobs.remove(id).await;
        }
    }
}

/// The description of all that is below.
#[derive(OpenApi)]
#[openapi(info(
    title = "geo-adapt",
    description = "Models, meshes and fields are kept, and the commands of geo-adapt run on them. Upload files, ask for a job on them, watch it, download its results."
))]
struct Description;

fn routes() -> OpenApiRouter<Shared> {
    OpenApiRouter::with_openapi(Description::openapi())
        .routes(routes!(about::me))
        .routes(routes!(about::commands))
        .routes(routes!(about::begin_session, about::end_session))
        .routes(routes!(files::list, files::add))
        .routes(routes!(files::get, files::remove))
        .routes(routes!(files::content))
        .routes(routes!(files::models))
        .routes(routes!(files::meshes))
        .routes(routes!(files::fields))
        .routes(routes!(uploads::begin))
        .routes(routes!(uploads::offset, uploads::append, uploads::give_up))
        .routes(routes!(jobs::list, jobs::add))
        .routes(routes!(jobs::get, jobs::remove))
        .routes(routes!(jobs::cancel))
        .routes(routes!(jobs::log))
        .routes(routes!(jobs::results))
        .routes(routes!(jobs::result))
        .routes(routes!(events::events))
}

/// All that is served.
pub fn router(service: &Shared) -> Router {
    let (routes, description) = OpenApiRouter::new().nest("/v1", routes()).split_for_parts();
    let fixed = |name: HeaderName, value: &'static str| {
        SetResponseHeaderLayer::if_not_present(name, HeaderValue::from_static(value))
    };
    routes
        .merge(about::router(description))
        .merge(page::router())
        .fallback(error::not_found)
        .method_not_allowed_fallback(error::no_such_method)
        .layer(axum::middleware::from_fn_with_state(Arc::clone(service), caller::guard))
        .layer(axum::middleware::from_fn_with_state(Arc::clone(service), figures::count))
        .layer(DefaultBodyLimit::max(MOST_JSON))
        .layer(CatchPanicLayer::custom(error::panicked))
        .layer(fixed(header::X_CONTENT_TYPE_OPTIONS, "nosniff"))
        .layer(fixed(header::X_FRAME_OPTIONS, "SAMEORIGIN"))
        .layer(fixed(header::REFERRER_POLICY, "no-referrer"))
        .layer(fixed(header::CACHE_CONTROL, "no-store"))
        .with_state(Arc::clone(service))
}

/// Listens until the process is asked to end.
///
/// # Errors
/// When the address is not to be had.
pub async fn listen(service: &Shared, told: impl FnOnce(String)) -> Result<(), Error> {
    let settings = &service.settings;
    let address = settings.listen;
    let listener = std::net::TcpListener::bind(address).map_err(Error::disk(address))?;
    listener.set_nonblocking(true).map_err(Error::disk(address))?;
    let address = listener.local_addr().map_err(Error::disk(address))?;
    let handle = axum_server::Handle::new();
    let ends = handle.clone();
    tokio::spawn(async move {
        asked_to_end().await;
        ends.graceful_shutdown(Some(PATIENCE));
    });
    let app = router(service).into_make_service_with_connect_info::<SocketAddr>();
    let timer = hyper_util::rt::TokioTimer::new;
    let served = match &settings.tls {
        None => {
            let mut server = axum_server::from_tcp(listener).map_err(Error::disk(address))?.handle(handle);
            server.http_builder().http1().timer(timer()).header_read_timeout(HEAD);
            told(format!("http://{address}"));
            server.serve(app).await
        }
        Some(tls) => {
            let config = certified(tls).await?;
            let server = axum_server::from_tcp_rustls(listener, config).map_err(Error::disk(address))?;
            let mut server = server.handle(handle);
            server.http_builder().http1().timer(timer()).header_read_timeout(HEAD);
            told(format!("https://{address}"));
            server.serve(app).await
        }
    };
    served.map_err(Error::disk(address))
}

/// Certificates and key, as rustls has them.
async fn certified(tls: &Tls) -> Result<RustlsConfig, Error> {
    let read = |path: &Path| std::fs::read(path).map_err(Error::disk(path.display()));
    let (certificates, key) = (read(&tls.certificate)?, read(&tls.key)?);
    let _ = rustls::crypto::ring::default_provider().install_default();
    let both = format!("{} with {}", tls.certificate.display(), tls.key.display());
    RustlsConfig::from_pem(certificates, key).await.map_err(Error::disk(both))
}

async fn asked_to_end() {
    let mut term = match tokio::signal::unix::signal(tokio::signal::unix::SignalKind::terminate()) {
        Ok(term) => term,
        Err(_) => return std::future::pending().await,
    };
    tokio::select! {
        _ = tokio::signal::ctrl_c() => {}
        _ = term.recv() => {}
    }
}
