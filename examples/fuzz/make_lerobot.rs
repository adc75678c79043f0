//! LeRobot data sets of both layouts: what `meta/info.json` says, and one file of rows that are lists.

use std::sync::Arc;

use arrow::array::{ArrayRef, FixedSizeListArray, Float32Array, Int64Array};
use arrow::datatypes::{DataType, Field, Schema};
use arrow::record_batch::RecordBatch;
use parquet::arrow::ArrowWriter;

/// What is said of the data, and the rows.
pub fn sets() -> Vec<[Vec<u8>; 2]> {
    let layouts = [
        ("v2.1", "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet"),
        ("v3.0", "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"),
    ];
    layouts.map(|(version, path)| [info(version, path).into_bytes(), rows()]).to_vec()
}

fn info(version: &str, path: &str) -> String {
    let feature =
        "{\"dtype\": \"float32\", \"shape\": [2], \"names\": [\"pan.pos\", \"tilt.pos\"]}";
    format!(
        "{{\"codebase_version\": \"{version}\", \"robot_type\": \"two\", \"fps\": 30, \"total_episodes\": 1, \
         \"chunks_size\": 1000, \"data_path\": \"{path}\", \"features\": {{\"action\": {feature}, \
         \"observation.state\": {feature}}}}}"
    )
}

fn rows() -> Vec<u8> {
    let item = Arc::new(Field::new("item", DataType::Float32, true));
    let list = |shift: f32| -> ArrayRef {
        let values = Float32Array::from_iter_values((0..40).map(|k| k as f32 + shift));
        Arc::new(FixedSizeListArray::new(item.clone(), 2, Arc::new(values), None))
    };
    let columns: Vec<(&str, ArrayRef)> = vec![
        ("action", list(1.0)),
        ("observation.state", list(0.0)),
        ("timestamp", Arc::new(Float32Array::from_iter_values((0..20).map(|k| k as f32 / 30.0)))),
        ("episode_index", Arc::new(Int64Array::from_iter_values(vec![0; 20]))),
    ];
    let field = |(name, c): &(&str, ArrayRef)| Field::new(*name, c.data_type().clone(), true);
    let schema = Arc::new(Schema::new(columns.iter().map(field).collect::<Vec<_>>()));
    let columns = columns.into_iter().map(|(_, c)| c).collect();
    let batch = RecordBatch::try_new(schema.clone(), columns).expect("columns of one length");
    let mut file = Vec::new();
    let mut out = ArrowWriter::try_new(&mut file, schema, None).expect("a writer");
    out.write(&batch).expect("rows");
    out.close().expect("a footer");
    file
}
