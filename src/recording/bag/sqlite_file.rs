//! rosbag2's SQLite storage (`.db3`): a table of topics and one of messages.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use rusqlite::limits::Limit;
use rusqlite::{Connection, ErrorCode, OpenFlags, OptionalExtension, params};

use super::bad;
use super::outgoing::Outgoing;
use super::topics::Topics;
use crate::limits::{CHUNK, Expansion, STEPS, TooMuch};
use crate::recording::RecordingError;
use crate::recording::file::cannot;

/// What any bag may take.
const FEW_STEPS: u64 = 100_000;
/// Between two looks at how many they were.
const STEPS_PER_LOOK: u64 = 1_000;

pub fn read(path: &Path, topics: &mut Topics) -> Result<(), RecordingError> {
    let length = refuse_short(path)?;
    let database = open(path, length).map_err(|e| broken(&e, path, 0))?;
    ["topics", "messages"].iter().try_for_each(|table| refuse_made_up(&database, table, path))?;
    let wrong = |e: rusqlite::Error| broken(&e, path, topics.joint_states());
    let mut wanted = Vec::new();
    {
        let query = "SELECT id, name, type, serialization_format FROM topics";
        let mut statement = database.prepare(query).map_err(wrong)?;
        let mut rows = statement.query([]).map_err(wrong)?;
        while let Some(row) = rows.next().map_err(|e| broken(&e, path, topics.joint_states()))? {
            let text =
                |column| row.get_ref(column).ok().and_then(|v| v.as_str().ok()).unwrap_or("");
            let number: i64 = row.get(0).map_err(|e| broken(&e, path, topics.joint_states()))?;
            topics.add(number as u64, text(1), text(2), text(3))?;
            if topics.wants(number as u64) {
                wanted.push(number.to_string());
            }
        }
    }
    let mut expansion = Expansion::default();
    expansion.take(length);
    messages(&database, &wanted.join(","), path, topics, expansion)
}

/// Opens a bag of `length` bytes as sqlite.org/security.html advises for files of others: no functions
/// in its schema, and an end to work that the file does not account for.
fn open(path: &Path, length: u64) -> rusqlite::Result<Connection> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let mut database = Connection::open_with_flags(path, flags)?;
    database.pragma_update(None, "trusted_schema", false)?;
    database.pragma_update(None, "cell_size_check", true)?;
    database.set_limit(Limit::SQLITE_LIMIT_LENGTH, CHUNK.most as i32)?;
    let mut left = FEW_STEPS.max(length.saturating_mul(STEPS.most)) / STEPS_PER_LOOK;
    let look = move || {
        left = left.saturating_sub(1);
        left == 0
    };
    database.progress_handler(STEPS_PER_LOOK as i32, Some(look))?;
    Ok(database)
}

/// A view or a generated column can make rows without end out of nothing.
fn refuse_made_up(database: &Connection, table: &str, path: &Path) -> Result<(), RecordingError> {
    let ask = |query: &str| -> rusqlite::Result<Option<String>> {
        database.query_row(query, [table], |row| row.get(0)).optional()
    };
    let kind = ask("SELECT type FROM pragma_table_list WHERE name = ?1");
    let kind = kind.map_err(|e| broken(&e, path, 0))?;
    let made = ask("SELECT name FROM pragma_table_xinfo(?1) WHERE hidden > 0");
    let made = made.map_err(|e| broken(&e, path, 0))?;
    let what = match (kind.as_deref(), made) {
        (None, _) | (Some("table"), None) => return Ok(()),
        (Some("table"), Some(column)) => format!("column {column} of {table} is computed"),
        (Some(kind), _) => format!("{table} is a {kind}, no table"),
    };
    let file = path.display().to_string();
    Err(bad(&file, what, "copy the messages into a plain bag (ros2 bag convert)"))
}

/// SQLite takes zeros for what a cut file lacks of its last page; its header says how long it was.
/// Returns how long it is.
fn refuse_short(path: &Path) -> Result<u64, RecordingError> {
    let mut header = [0; 100];
    let mut file = File::open(path).map_err(cannot(path, "read"))?;
    let length = file.metadata().map_err(cannot(path, "read"))?.len();
    let whole = file.read_exact(&mut header).is_ok();
    let page = match u16::from_be_bytes([header[16], header[17]]) {
        1 => 65536,
        size => u64::from(size),
    };
    let pages = u32::from_be_bytes([header[28], header[29], header[30], header[31]]);
    if whole && length >= page * u64::from(pages) {
        return Ok(length);
    }
    let what = format!("the bag is cut off: {length} of {} bytes", page * u64::from(pages));
    Err(bad(&path.display().to_string(), what, "copy it again"))
}

fn messages(
    database: &Connection,
    wanted: &str,
    path: &Path,
    topics: &mut Topics,
    mut expansion: Expansion,
) -> Result<(), RecordingError> {
    let query = format!(
        "SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN ({wanted}) \
         ORDER BY timestamp, id"
    );
    let mut statement = database.prepare(&query).map_err(|e| broken(&e, path, 0))?;
    let mut rows = statement.query([]).map_err(|e| broken(&e, path, 0))?;
    loop {
        let count = topics.joint_states();
        let wrong = |e: &rusqlite::Error| broken(e, path, count);
        let Some(row) = rows.next().map_err(|e| wrong(&e))? else { return Ok(()) };
        let topic: i64 = row.get(0).map_err(|e| wrong(&e))?;
        let logged: i64 = row.get(1).map_err(|e| wrong(&e))?;
        let data = row.get_ref(2).map_err(|e| wrong(&e))?;
        let data = data.as_blob().map_err(|e| wrong(&e.into()))?;
        expansion.make(data.len() as u64).map_err(|limit| too_much(limit, path))?;
        topics.message(topic as u64, logged, data)?;
    }
}

fn broken(error: &rusqlite::Error, path: &Path, count: usize) -> RecordingError {
    if error.sqlite_error_code() == Some(ErrorCode::OperationInterrupted) {
        return too_much(TooMuch(&STEPS), path);
    }
    let file = path.display().to_string();
    let text = error.to_string();
    if text.contains("no such table") || text.contains("no such column") {
        return bad(&file, format!("it is a database, but not a bag ({text})"), "check the path");
    }
    let what = format!("the bag is cut off or damaged after {count} joint states ({text})");
    bad(&file, what, "copy it again, or mend it with `sqlite3 FILE .recover`")
}

fn too_much(limit: TooMuch, path: &Path) -> RecordingError {
    RecordingError::TooMuch { file: path.display().to_string(), limit }
}

const TABLES: &str = "
    CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
        serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
    CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,
        timestamp INTEGER NOT NULL, data BLOB NOT NULL);
    CREATE INDEX timestamp_idx ON messages (timestamp ASC);";

/// Writes a bag into the empty file `path`.
pub fn write(bag: &Outgoing, path: &Path) -> rusqlite::Result<()> {
    let mut database = Connection::open(path)?;
    database.pragma_update(None, "journal_mode", "OFF")?;
    let all = database.transaction()?;
    all.execute_batch(TABLES)?;
    for (number, (topic, kind)) in bag.topics().enumerate() {
        let insert = "INSERT INTO topics VALUES (?1, ?2, ?3, 'cdr', '')";
        all.execute(insert, params![number as i64 + 1, topic, kind])?;
    }
    {
        let insert = "INSERT INTO messages (topic_id, timestamp, data) VALUES (?1, ?2, ?3)";
        let mut insert = all.prepare(insert)?;
        for sample in 0..bag.samples() {
            for topic in 0..bag.topics().count() {
                let message = bag.message(topic, sample);
                insert.execute(params![topic as i64 + 1, bag.stamp(sample), message])?;
            }
        }
    }
    all.commit()
}
