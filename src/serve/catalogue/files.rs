//! Whose contents are what.
use super::Catalogue;
use crate::serve::ids::now;
use serde::{Deserialize, Serialize};
use sqlx::Row;
use sqlx::any::AnyRow;
use utoipa::ToSchema;

/// What a file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A CAD model: STEP, IGES, BREP, EGADS.
    Model,
    /// A mesh, of any format.
    Mesh,
    /// Fields or a metric on a mesh.
    Field,
    /// Whatever else a command reads.
    Other,
}

impl Kind {
    /// As the database has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Mesh => "mesh",
            Self::Field => "field",
            Self::Other => "other",
        }
    }

    fn of(name: &str) -> Self {
        [Self::Model, Self::Mesh, Self::Field].into_iter().find(|kind| kind.name() == name).unwrap_or(Self::Other)
    }

    /// What the ending of a name tells.
    pub fn of_file(name: &str) -> Self {
        let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase()).unwrap_or_default();
        match ending.as_str() {
            "step" | "stp" | "iges" | "igs" | "brep" | "egads" => Self::Model,
            "sol" | "solb" | "dat" | "csv" => Self::Field,
            "mesh" | "meshb" | "su2" | "vtu" | "vtk" | "msh" | "cgns" | "xdmf" | "ugrid" | "stl" | "inp" | "nas"
            | "bdf" => Self::Mesh,
            _ => Self::Other,
        }
    }
}

/// Contents that an owner has uploaded.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
pub struct File {
    /// SHA-256 of the contents, in hexadecimal digits: the same contents are one file.
    pub id: String,
    /// What it is for.
    pub kind: Kind,
    /// What it was called.
    pub name: String,
    /// How many bytes it has.
    pub bytes: i64,
    /// When it was uploaded, milliseconds since 1970.
    pub created: i64,
}

impl File {
    fn of(row: &AnyRow) -> Result<Self, sqlx::Error> {
        let kind: String = row.try_get("kind")?;
        Ok(Self {
            id: row.try_get("id")?,
            kind: Kind::of(&kind),
            name: row.try_get("name")?,
            bytes: row.try_get("bytes")?,
            created: row.try_get("created")?,
        })
    }
}

impl Catalogue {
    /// Notes that an owner has contents; the last name counts.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn add_file(
        &self,
        owner: &str,
        (id, bytes): (&str, u64),
        kind: Kind,
        name: &str,
    ) -> Result<File, sqlx::Error> {
        let text = "INSERT INTO files (owner, id, kind, name, bytes, created) VALUES ($1, $2, $3, $4, $5, $6)
            ON CONFLICT (owner, id) DO UPDATE SET kind = excluded.kind, name = excluded.name";
        let (bytes, created) = (bytes as i64, now());
        sqlx::query(text)
            .bind(owner)
            .bind(id)
            .bind(kind.name())
            .bind(name)
            .bind(bytes)
            .bind(created)
            .execute(&self.writer)
            .await?;
        Ok(File { id: id.into(), kind, name: name.into(), bytes, created })
    }

    /// A file of an owner.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn file(&self, owner: &str, id: &str) -> Result<Option<File>, sqlx::Error> {
        let row = sqlx::query("SELECT * FROM files WHERE owner = $1 AND id = $2").bind(owner).bind(id);
        row.fetch_optional(&self.pool).await?.as_ref().map(File::of).transpose()
    }

    /// Whether an owner may read contents: an upload, or what a job of theirs has made.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn may_read(&self, owner: &str, id: &str) -> Result<bool, sqlx::Error> {
        let text = "SELECT 1 WHERE EXISTS (SELECT 1 FROM files WHERE owner = $1 AND id = $2)
            OR EXISTS (SELECT 1 FROM results r JOIN jobs j ON j.id = r.job WHERE j.owner = $1 AND r.id = $2)";
        Ok(sqlx::query(text).bind(owner).bind(id).fetch_optional(&self.pool).await?.is_some())
    }

    /// The files of an owner, the newest first.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn files(&self, owner: &str, kind: Option<Kind>, most: i64) -> Result<Vec<File>, sqlx::Error> {
        let text = "SELECT * FROM files WHERE owner = $1 AND ($2 = '' OR kind = $2) ORDER BY created DESC, id LIMIT $3";
        let kind = kind.map_or("", Kind::name);
        let rows = sqlx::query(text).bind(owner).bind(kind).bind(most).fetch_all(&self.pool).await?;
        rows.iter().map(File::of).collect()
    }

    /// Forgets a file; whether there was one.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn remove_file(&self, owner: &str, id: &str) -> Result<bool, sqlx::Error> {
        let text = "DELETE FROM files WHERE owner = $1 AND id = $2";
        Ok(sqlx::query(text).bind(owner).bind(id).execute(&self.writer).await?.rows_affected() > 0)
    }

    /// Bytes that an owner keeps: uploads and results.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn bytes_of(&self, owner: &str) -> Result<u64, sqlx::Error> {
        let text = "SELECT CAST((SELECT COALESCE(SUM(bytes), 0) FROM files WHERE owner = $1)
            + (SELECT COALESCE(SUM(r.bytes), 0) FROM results r JOIN jobs j ON j.id = r.job WHERE j.owner = $1) AS BIGINT)";
        let bytes: i64 = sqlx::query(text).bind(owner).fetch_one(&self.pool).await?.try_get(0)?;
        Ok(u64::try_from(bytes).unwrap_or(0))
    }

    /// Whether nobody has contents any more.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn is_forgotten(&self, id: &str) -> Result<bool, sqlx::Error> {
        // A job that has not ended may read them.
        let text =
            "SELECT 1 WHERE EXISTS (SELECT 1 FROM files WHERE id = $1) OR EXISTS (SELECT 1 FROM results WHERE id = $1)
            OR EXISTS (SELECT 1 FROM jobs WHERE state IN ('queued', 'running') AND request LIKE $2)";
        Ok(sqlx::query(text).bind(id).bind(format!("%{id}%")).fetch_optional(&self.pool).await?.is_none())
    }
}
