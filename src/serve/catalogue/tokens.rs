//! Who may: tokens, of which the database has the hash alone.
use super::Catalogue;
use crate::serve::ids::{digest, hex, new_id, now, random};
use sqlx::Row;
use sqlx::any::AnyRow;

/// What a token is good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// To look and to download.
    Read,
    /// To upload, to start and to end jobs, to remove.
    Write,
    /// To see the figures of the service.
    Metrics,
}

impl Scope {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Read, Self::Write, Self::Metrics];

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Write => "write",
            Self::Metrics => "metrics",
        }
    }

    /// Of a text.
    ///
    /// # Errors
    /// When there is no such scope.
    pub fn parse(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|scope| scope.name() == text);
        found.ok_or_else(|| format!("{text}: the scopes are read, write and metrics"))
    }
}

/// A token, as it is known.
#[derive(Clone, Debug)]
pub struct Token {
    /// What it is called, to revoke it.
    pub id: String,
    /// Whose it is.
    pub owner: String,
    /// What it is good for.
    pub scopes: Vec<Scope>,
    /// For whoever reads the list.
    pub label: String,
    /// When it was made, milliseconds since 1970.
    pub created: i64,
    /// Until when it is good.
    pub expires: Option<i64>,
    /// Since when it is not.
    pub revoked: Option<i64>,
}

impl Token {
    fn of(row: &AnyRow) -> Result<Self, sqlx::Error> {
        let scopes: String = row.try_get("scopes")?;
        Ok(Self {
            id: row.try_get("id")?,
            owner: row.try_get("owner")?,
            scopes: scopes.split(' ').filter_map(|scope| Scope::parse(scope).ok()).collect(),
            label: row.try_get("label")?,
            created: row.try_get("created")?,
            expires: row.try_get("expires")?,
            revoked: row.try_get("revoked")?,
        })
    }
}

impl Catalogue {
    /// Makes a token, and returns the only text of it that there will be.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn make_token(
        &self,
        owner: &str,
        scopes: &[Scope],
        label: &str,
        expires: Option<i64>,
    ) -> Result<String, sqlx::Error> {
        let secret = format!("ga_{}", hex(&random::<32>()?));
        let scopes: Vec<&str> = scopes.iter().map(|scope| scope.name()).collect();
        let text =
            "INSERT INTO tokens (id, hash, owner, scopes, label, created, expires) VALUES ($1, $2, $3, $4, $5, $6, $7)";
        let id = new_id()?[..16].to_owned();
        let query = sqlx::query(text).bind(id).bind(digest(secret.as_bytes())).bind(owner).bind(scopes.join(" "));
        query.bind(label).bind(now()).bind(expires).execute(&self.writer).await?;
        Ok(secret)
    }

    /// The token of a text, as long as it is good.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn token(&self, secret: &str) -> Result<Option<Token>, sqlx::Error> {
        let row = sqlx::query("SELECT * FROM tokens WHERE hash = $1").bind(digest(secret.as_bytes()));
        let token = row.fetch_optional(&self.pool).await?.as_ref().map(Token::of).transpose()?;
        Ok(token.filter(|token| token.revoked.is_none() && token.expires.is_none_or(|end| end > now())))
    }

    /// All tokens.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn tokens(&self) -> Result<Vec<Token>, sqlx::Error> {
        let rows = sqlx::query("SELECT * FROM tokens ORDER BY created, id").fetch_all(&self.pool).await?;
        rows.iter().map(Token::of).collect()
    }

    /// A token is good for nothing any more; whether there was one.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn revoke(&self, id: &str) -> Result<bool, sqlx::Error> {
        let text = "UPDATE tokens SET revoked = $2 WHERE id = $1 AND revoked IS NULL";
        Ok(sqlx::query(text).bind(id).bind(now()).execute(&self.writer).await?.rows_affected() > 0)
    }
}
