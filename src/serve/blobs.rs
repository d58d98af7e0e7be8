//! Contents, each once, by their SHA-256: in a folder, or in a store that speaks S3.
use super::ids::{hex, is_digest, new_id};
use super::{Error, Settings};
use futures_util::StreamExt;
use futures_util::stream::BoxStream;
use object_store::aws::AmazonS3Builder;
use object_store::buffered::BufWriter;
use object_store::path::Path as Key;
use object_store::prefix::PrefixStore;
use object_store::{GetOptions, GetRange, ObjectStore};
use sha2::{Digest, Sha256};
use std::io::{self, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tokio::fs;
use tokio::io::{AsyncReadExt, AsyncWriteExt};

/// So many bytes are read at once.
const BUFFER: usize = 1 << 18;

/// What says in a store that a service has its contents there.
const MARK: &str = "geo-adapt";

/// Where contents lie.
#[derive(Clone)]
pub enum Blobs {
    /// In files of a folder.
    Folder(PathBuf),
    /// In a store.
    Store(Arc<dyn ObjectStore>),
}

/// Contents on the way to a client.
pub type Stream = BoxStream<'static, io::Result<Vec<u8>>>;

fn other(error: impl std::error::Error + Send + Sync + 'static) -> io::Error {
    io::Error::other(error)
}

/// The digest of a file.
///
/// # Errors
/// When it cannot be read.
pub fn digest_of(path: &Path) -> io::Result<String> {
    let (mut file, mut digest) = (std::fs::File::open(path)?, Sha256::new());
    let mut bytes = vec![0; BUFFER];
    loop {
        match file.read(&mut bytes)? {
            0 => return Ok(hex(&digest.finalize())),
            read => digest.update(&bytes[..read]),
        }
    }
}

impl Blobs {
    /// As the operator has it: a folder of the data, another one, or s3://bucket/prefix with its keys in the environment (AWS_…).
    ///
    /// # Errors
    /// When the address is none, or the store does not take what is sent.
    pub async fn open(settings: &Settings) -> Result<Self, Error> {
        match settings.store.as_deref() {
            Some(address) if address.starts_with("s3://") => {
                let store = AmazonS3Builder::from_env().with_url(address).build()?;
                let prefix = address["s3://".len()..].split_once('/').map_or("", |(_, prefix)| prefix);
                let store = PrefixStore::new(store, Key::from(prefix));
                // What is wrong with the bucket or its keys is known before the first upload.
                store.put(&Key::from(MARK), env!("CARGO_PKG_VERSION").into()).await?;
                Ok(Self::Store(Arc::new(store)))
            }
            Some(address) if address.contains("://") => {
                Err(Error::Settings(format!("{address}: the store is a folder, or s3://BUCKET")))
            }
            Some(folder) => {
                std::fs::create_dir_all(folder).map_err(Error::disk(folder))?;
                Ok(Self::Folder(folder.into()))
            }
            None => Ok(Self::Folder(settings.folder("blobs"))),
        }
    }

    fn path(folder: &Path, id: &str) -> PathBuf {
        folder.join(&id[..2]).join(id)
    }

    fn key(id: &str) -> Key {
        Key::from(format!("{}/{id}", &id[..2]))
    }

    /// Takes a file in, whose digest is known: it is moved where that can be. On return the contents are on the disk.
    ///
    /// # Errors
    /// When they cannot be kept.
    pub async fn put(&self, from: &Path, id: &str) -> io::Result<()> {
        if self.has(id).await? {
            return fs::remove_file(from).await;
        }
        match self {
            Self::Folder(folder) => {
                let target = Self::path(folder, id);
                let parent = folder.join(&id[..2]);
                fs::create_dir_all(&parent).await?;
                let file = fs::File::open(from).await?;
                file.sync_all().await?;
                if fs::rename(from, &target).await.is_err() {
                    // On another disk.
                    let beside = parent.join(format!("{}.part", new_id()?));
                    fs::copy(from, &beside).await?;
                    fs::File::open(&beside).await?.sync_all().await?;
                    fs::rename(&beside, &target).await?;
                    fs::remove_file(from).await?;
                }
                read_only(&target).await?;
                fs::File::open(&parent).await?.sync_all().await
            }
            Self::Store(store) => {
                let mut to = BufWriter::new(Arc::clone(store), Self::key(id));
                let mut file = fs::File::open(from).await?;
                tokio::io::copy(&mut file, &mut to).await?;
                to.shutdown().await?;
                fs::remove_file(from).await
            }
        }
    }

    /// Whether contents are there.
    ///
    /// # Errors
    /// When the store does not answer.
    pub async fn has(&self, id: &str) -> io::Result<bool> {
        if !is_digest(id) {
            return Ok(false);
        }
        match self {
            Self::Folder(folder) => fs::try_exists(Self::path(folder, id)).await,
            Self::Store(store) => match store.head(&Self::key(id)).await {
                Ok(_) => Ok(true),
                Err(object_store::Error::NotFound { .. }) => Ok(false),
                Err(error) => Err(other(error)),
            },
        }
    }

    /// Puts contents at a path, for reading alone: a further name of the same file, where that can be.
    ///
    /// # Errors
    /// When they are not there, or there is no room.
    pub async fn place(&self, id: &str, at: &Path) -> io::Result<()> {
        match self {
            Self::Folder(folder) => {
                let from = Self::path(folder, id);
                if fs::hard_link(&from, at).await.is_ok() {
                    return Ok(());
                }
                fs::copy(&from, at).await?;
                read_only(at).await
            }
            Self::Store(store) => {
                let mut stream = store.get(&Self::key(id)).await.map_err(other)?.into_stream();
                let mut file = fs::File::create(at).await?;
                while let Some(bytes) = stream.next().await {
                    file.write_all(&bytes.map_err(other)?).await?;
                }
                file.flush().await?;
                read_only(at).await
            }
        }
    }

    /// A range of contents, as a stream.
    ///
    /// # Errors
    /// When they are not there.
    pub async fn read(&self, id: &str, range: Range<u64>) -> io::Result<Stream> {
        match self {
            Self::Folder(folder) => {
                let mut file = fs::File::open(Self::path(folder, id)).await?;
                tokio::io::AsyncSeekExt::seek(&mut file, io::SeekFrom::Start(range.start)).await?;
                let left = file.take(range.end.saturating_sub(range.start));
                Ok(futures_util::stream::try_unfold(left, |mut left| async move {
                    let mut bytes = vec![0; BUFFER.min(usize::try_from(left.limit()).unwrap_or(BUFFER))];
                    let read = left.read(&mut bytes).await?;
                    bytes.truncate(read);
                    Ok((read > 0).then_some((bytes, left)))
                })
                .boxed())
            }
            Self::Store(store) => {
                let options = GetOptions { range: Some(GetRange::Bounded(range)), ..Default::default() };
                let found = store.get_opts(&Self::key(id), options).await.map_err(other)?;
                Ok(found.into_stream().map(|bytes| bytes.map(|bytes| bytes.to_vec()).map_err(other)).boxed())
            }
        }
    }

    /// Forgets contents. That they stay does no harm.
    pub async fn remove(&self, id: &str) {
        match self {
            Self::Folder(folder) => drop(fs::remove_file(Self::path(folder, id)).await),
            Self::Store(store) => drop(store.delete(&Self::key(id)).await),
        }
    }
}

/// A job that writes to its input by mistake gets an error.
async fn read_only(path: &Path) -> io::Result<()> {
    let mut rights = fs::metadata(path).await?.permissions();
    rights.set_readonly(true);
    fs::set_permissions(path, rights).await
}

#[cfg(test)]
mod tests {
    use super::*;
    use object_store::memory::InMemory;

    async fn keeps(blobs: Blobs) {
        let folder = tempfile::tempdir().unwrap();
        let contents: Vec<u8> = (0..600_000_u32).map(|i| (i % 251) as u8).collect();
        let from = folder.path().join("a");
        std::fs::write(&from, &contents).unwrap();
        let id = digest_of(&from).unwrap();
        assert!(!blobs.has(&id).await.unwrap() && !blobs.has("..").await.unwrap());
        blobs.put(&from, &id).await.unwrap();
        assert!(blobs.has(&id).await.unwrap() && !from.exists());
        // Twice is once.
        std::fs::write(&from, &contents).unwrap();
        blobs.put(&from, &id).await.unwrap();
        let at = folder.path().join("b");
        blobs.place(&id, &at).await.unwrap();
        assert!(std::fs::read(&at).unwrap() == contents);
        for range in [0..600_000, 5..10, 599_999..600_000, 7..7] {
            if range.is_empty() {
                continue;
            }
            let parts: Vec<_> = blobs.read(&id, range.clone()).await.unwrap().collect().await;
            let found: Vec<u8> = parts.into_iter().flat_map(Result::unwrap).collect();
            assert!(found == contents[range.start as usize..range.end as usize], "{range:?}");
        }
        blobs.remove(&id).await;
        assert!(!blobs.has(&id).await.unwrap());
    }

    #[tokio::test]
    async fn a_folder_keeps_contents() {
        let folder = tempfile::tempdir().unwrap();
        keeps(Blobs::Folder(folder.path().into())).await;
    }

    #[tokio::test]
    async fn a_store_keeps_contents() {
        keeps(Blobs::Store(Arc::new(InMemory::new()))).await;
        let folder = tempfile::tempdir().unwrap();
        let local = object_store::local::LocalFileSystem::new_with_prefix(folder.path()).unwrap();
        keeps(Blobs::Store(Arc::new(local))).await;
    }
}
