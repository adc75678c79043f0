//! Bags of SQLite: small pages, odd schemas, and changes by SQL as well as of bytes.

use std::path::Path;

use rusqlite::Connection;

use crate::bytes::{Random, havoc};
use crate::targets::{Corpus, seed_file};

const SCHEMAS: &[&str] = &[
    "",
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC)",
    "ALTER TABLE messages RENAME TO m; CREATE VIEW messages AS SELECT * FROM m",
    "ALTER TABLE messages RENAME TO m; CREATE VIEW messages AS WITH RECURSIVE r(n) AS (SELECT 1 UNION \
     ALL SELECT n + 1 FROM r) SELECT n AS id, 1 AS topic_id, n AS timestamp, data FROM r, m",
    "ALTER TABLE topics RENAME TO t; CREATE VIEW topics AS WITH RECURSIVE r(n) AS (SELECT 1 UNION ALL \
     SELECT n + 1 FROM r) SELECT n AS id, name, type, serialization_format FROM r, t",
    "ALTER TABLE messages ADD COLUMN more AS (zeroblob(100000000))",
    "DROP TABLE messages; CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data AS \
     (zeroblob(100000000)))",
    "DROP TABLE messages; CREATE VIRTUAL TABLE messages USING fts5(topic_id, timestamp, data)",
    "DROP TABLE topics",
    "DELETE FROM messages",
    "UPDATE messages SET data = 'text'",
    "UPDATE messages SET data = NULL",
    "UPDATE messages SET timestamp = 'late'",
    "ALTER TABLE topics RENAME TO t; CREATE TABLE topics AS SELECT 'one' AS id, name, type, \
     serialization_format FROM t",
    "UPDATE topics SET id = -1; UPDATE messages SET topic_id = -1",
    "CREATE TABLE metadata(a); PRAGMA journal_mode = WAL",
];

/// So many seeds are plain bags; to ask one of the others may take for ever.
const PLAIN: usize = 3;

fn open(path: &Path) -> Connection {
    let _ = std::fs::remove_file(path);
    Connection::open(path).expect("a database")
}

/// One bag for each odd schema.
pub fn seeds() -> Vec<Vec<u8>> {
    let whole = seed_file("tests/bags/rosbags.db3");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.db3");
    let mut all = vec![whole.clone()];
    std::fs::write(folder.path().join("whole.db3"), &whole).expect("room");
    for schema in SCHEMAS {
        let database = open(&path);
        let attach = format!("ATTACH '{}' AS whole", folder.path().join("whole.db3").display());
        let copy = "PRAGMA page_size = 512;
            CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);
            CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);";
        let fill = "INSERT INTO topics SELECT id, name, type, serialization_format FROM whole.topics;
            INSERT INTO messages SELECT id, topic_id, timestamp, data FROM whole.messages LIMIT 30;";
        let made = database.execute_batch(copy).and_then(|()| {
            database.execute_batch(&format!("{attach}; {fill}"))?;
            database.execute_batch("DETACH whole")?;
            database.execute_batch(schema)
        });
        drop(database);
        made.unwrap_or_else(|e| panic!("{schema}: {e}"));
        all.push(std::fs::read(&path).expect("a bag"));
    }
    all
}

pub fn make(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    let mut file = corpus.pick(random);
    if random.one_in(8)
        && let Some(changed) = by_sql(random, corpus)
    {
        file = changed;
    }
    if random.one_in(4) && file.len() >= 1024 {
        // Pages change places, so that trees lead in circles.
        let pages = file.len() / 512;
        let (from, to) = (random.below(pages) * 512, (1 + random.below(pages - 1)) * 512);
        file.copy_within(from..from + 512, to);
    }
    let length = file.len();
    havoc(random, &mut file, &corpus.words, &[]);
    // A bag that is cut off is refused at once.
    file.resize(length.max(file.len()), 0);
    file
}

/// A seed, one message of it with other bytes.
fn by_sql(random: &mut Random, corpus: &Corpus) -> Option<Vec<u8>> {
    let file = random.of(&corpus.seeds[..PLAIN]);
    let path = tempfile::NamedTempFile::new_in(crate::targets::memory_folder()).ok()?;
    std::fs::write(path.path(), file).ok()?;
    let database = Connection::open(path.path()).ok()?;
    let id = 1 + random.below(12) as i64;
    let query = "SELECT data FROM messages WHERE id = ?1";
    let mut data: Vec<u8> = database.query_row(query, [id], |row| row.get(0)).ok()?;
    havoc(random, &mut data, &corpus.words, &[]);
    if random.one_in(3) {
        data = zstd::encode_all(data.as_slice(), 1).ok()?;
    }
    database.execute("UPDATE messages SET data = ?1 WHERE id = ?2", (data, id)).ok()?;
    drop(database);
    std::fs::read(path.path()).ok()
}
