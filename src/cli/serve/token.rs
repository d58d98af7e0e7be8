//! `serve token`: who may use a service that other machines reach.
use super::Place;
use crate::cli::{Outcome, print};
use crate::serve::{self, Scope};
use std::net::{Ipv4Addr, SocketAddr};
use std::process::ExitCode;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand)]
enum What {
    /// Make a token, and print it: nobody can print it again
    Add {
        /// Whose it is: who has a token of this owner sees all that is the owner's
        #[arg(value_name = "OWNER", value_parser = owner)]
        owner: String,
        /// What it is good for: read, write, metrics
        #[arg(long, value_name = "SCOPE,…", value_delimiter = ',', default_value = "read,write", value_parser = Scope::parse)]
        scopes: Vec<Scope>,
        /// What the list shows beside it
        #[arg(long, value_name = "TEXT", default_value = "")]
        label: String,
        /// After so many days it is good for nothing
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=36500))]
        days: Option<u32>,
        #[command(flatten)]
        place: Place,
    },
    /// List the tokens, without what is secret of them
    List {
        #[command(flatten)]
        place: Place,
    },
    /// A token is good for nothing any more
    Revoke {
        /// What the list calls it
        #[arg(value_name = "ID")]
        id: String,
        #[command(flatten)]
        place: Place,
    },
}

fn owner(text: &str) -> Result<String, String> {
    let is_plain = |b: u8| b.is_ascii_alphanumeric() || b"._-@".contains(&b);
    if (1..=64).contains(&text.len()) && text.bytes().all(is_plain) {
        return Ok(text.into());
    }
    Err("1 to 64 letters, digits and . _ - @".into())
}

/// Milliseconds since 1970, in so many days.
fn in_days(days: u32) -> i64 {
    let end = SystemTime::now() + Duration::from_secs(u64::from(days) * 24 * 3600);
    end.duration_since(UNIX_EPOCH).map_or(i64::MAX, |since| since.as_millis() as i64)
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let nowhere = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
    match &arguments.what {
        What::Add { owner, scopes, label, days, place } => {
            let expires = days.map(in_days);
            let made = serve::with_tokens(&place.settings(nowhere), async |catalogue| {
                catalogue.make_token(owner, scopes, label, expires).await
            })?;
            print(&format!("{made}\n"))?;
        }
        What::List { place } => {
            let tokens = serve::with_tokens(&place.settings(nowhere), async |catalogue| catalogue.tokens().await)?;
            let now = in_days(0);
            let mut text = String::from("id                owner             scopes              state    label\n");
            for token in tokens {
                let scopes: Vec<&str> = token.scopes.iter().map(|scope| scope.name()).collect();
                let state = match (token.revoked, token.expires) {
                    (Some(_), _) => "revoked",
                    (None, Some(end)) if end <= now => "expired",
                    _ => "good",
                };
                let (id, owner, scopes, label) = (&token.id, &token.owner, scopes.join(","), &token.label);
                text.push_str(&format!("{id:<17} {owner:<17} {scopes:<19} {state:<8} {label}\n"));
            }
            print(&text)?;
        }
        What::Revoke { id, place } => {
            let found = serve::with_tokens(&place.settings(nowhere), async |catalogue| catalogue.revoke(id).await)?;
            if !found {
                return Err(format!(
                    "{id}: there is no such token that is good; `geo-adapt serve token list` has them"
                )
                .into());
            }
        }
    }
    Ok(ExitCode::SUCCESS)
}
