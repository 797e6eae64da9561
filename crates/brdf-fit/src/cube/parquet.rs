//! The fits as a Parquet table: a row for each scan, with its place in the array.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{DoubleType, Int32Type, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};

use super::array::Cube;
use super::columns::{Column, Values};
use super::fit::PieceFit;
use crate::batch::Status;

/// Writes a table, a group of rows for each piece.
pub(super) struct Table<'a> {
    columns: &'a [Column],
    /// The shape of the scans, in the order in which they are counted: the last one runs fastest.
    shape: Vec<u64>,
    /// The table is made in memory, and taken from there after each group.
    file: SerializedFileWriter<Vec<u8>>,
    first: u64,
}

impl<'a> Table<'a> {
    pub(super) fn new(cube: &Cube, columns: &'a [Column]) -> io::Result<Self> {
        let mut shape = cube.scan_shape();
        let mut names: Vec<String> = (0..shape.len())
            .map(|axis| format!("axis_{axis}"))
            .collect();
        if cube.fortran_order() {
            shape.reverse();
            names.reverse();
        }
        let statuses = Status::ALL.iter().map(|status| {
            let key = format!("status {}", *status as u8);
            KeyValue::new(key, status.description().to_owned())
        });
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(statuses.collect()))
            .build();
        let schema = schema(&names, columns).map_err(io::Error::other)?;
        let file = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties));
        Ok(Self {
            columns,
            shape,
            file: file.map_err(io::Error::other)?,
            first: 0,
        })
    }

    /// Writes the fits of a piece.
    pub(super) fn write_rows(
        &mut self,
        writer: &mut dyn Write,
        piece: &PieceFit,
    ) -> io::Result<()> {
        self.write_group(piece).map_err(io::Error::other)?;
        self.first += piece.fit.len() as u64;
        self.file.flush()?;
        writer.write_all(&std::mem::take(self.file.inner_mut()))
    }

    /// Writes the end of the table.
    pub(super) fn finish(self, writer: &mut dyn Write) -> io::Result<()> {
        let rest = self.file.into_inner().map_err(io::Error::other)?;
        writer.write_all(&rest)
    }

    fn write_group(&mut self, piece: &PieceFit) -> parquet::errors::Result<()> {
        let scans = self.first..self.first + piece.fit.len() as u64;
        let mut group = self.file.next_row_group()?;
        let mut stride: u64 = self.shape.iter().product();
        for size in &self.shape {
            stride /= (*size).max(1);
            let place = |scan: u64| i64::try_from(scan / stride.max(1) % size).unwrap_or(i64::MAX);
            let places: Vec<i64> = scans.clone().map(place).collect();
            write_column::<Int64Type>(&mut group, &places)?;
        }
        for column in self.columns {
            match column.values(piece) {
                Values::Float(values) => write_column::<DoubleType>(&mut group, values)?,
                Values::Count(counts) => {
                    let counts = counts.iter().map(|count| count.cast_signed());
                    write_column::<Int32Type>(&mut group, &counts.collect::<Vec<i32>>())?;
                }
                Values::Code(codes) => {
                    let codes = codes.into_iter().map(i32::from);
                    write_column::<Int32Type>(&mut group, &codes.collect::<Vec<i32>>())?;
                }
            }
        }
        group.close()?;
        Ok(())
    }
}

fn write_column<T: parquet::data_type::DataType>(
    group: &mut SerializedRowGroupWriter<'_, Vec<u8>>,
    values: &[T::T],
) -> parquet::errors::Result<()> {
    if let Some(mut column) = group.next_column()? {
        column.typed::<T>().write_batch(values, None, None)?;
        column.close()?;
    }
    Ok(())
}

fn schema(axes: &[String], columns: &[Column]) -> parquet::errors::Result<TypePtr> {
    let axes = axes
        .iter()
        .map(|name| (name.clone(), Physical::INT64, ConvertedType::NONE));
    let columns = columns.iter().map(|column| {
        let (physical, converted) = match column {
            Column::Readings => (Physical::INT32, ConvertedType::UINT_32),
            Column::Status => (Physical::INT32, ConvertedType::UINT_8),
            _ => (Physical::DOUBLE, ConvertedType::NONE),
        };
        (column.name(), physical, converted)
    });
    let fields = axes.chain(columns).map(|(name, physical, converted)| {
        let field = Type::primitive_type_builder(&name, physical)
            .with_repetition(Repetition::REQUIRED)
            .with_converted_type(converted)
            .build()?;
        Ok(Arc::new(field))
    });
    let fields = fields.collect::<parquet::errors::Result<Vec<TypePtr>>>()?;
    Ok(Arc::new(
        Type::group_type_builder("fits")
            .with_fields(fields)
            .build()?,
    ))
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::ops::ControlFlow;

    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    use parquet::record::RowAccessor as _;

    use crate::batch::BatchOptions;
    use crate::cube::{Cube, CubeOptions, OutputFormat};
    use crate::read::ReadOptions;
    use crate::read::csv::AngleTable;

    #[test]
    fn each_scan_has_a_row_with_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let table = "psi_deg,theta_deg\n10,-50\n10,-10\n10,0\n10,30\n60,-60\n60,-20\n60,40\n";
        std::fs::write(path("angles.csv"), table).unwrap();
        let scan = [0.05, 0.4, 0.2, 0.06, 0.5, 0.1, 0.06];
        let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3, 7), }";
        bytes.extend(format!("{header:<117}\n").into_bytes());
        for i in 1..=6 {
            bytes.extend(
                scan.iter()
                    .flat_map(|value| (f64::from(i) * value).to_le_bytes()),
            );
        }
        std::fs::write(path("cube.npy"), bytes).unwrap();
        let angles = AngleTable::read(path("angles.csv"), &ReadOptions::default()).unwrap();
        let options = CubeOptions {
            batch: BatchOptions::default(),
            constant_noise_errors: true,
            intervals: true,
            format: OutputFormat::Parquet,
        };
        let mut cube = Cube::open(path("cube.npy"), 7, None).unwrap();
        let output = path("fits.parquet");
        cube.fit(&angles, &options, &output, &mut |_, _| {
            ControlFlow::Continue(())
        })
        .unwrap();
        let reader = SerializedFileReader::new(File::open(output).unwrap()).unwrap();
        let names = reader.metadata().file_metadata().schema().get_fields();
        let names: Vec<&str> = names.iter().map(|field| field.name()).collect();
        assert_eq!(
            names[..6],
            ["axis_0", "axis_1", "k2", "kd", "k1", "e_percent"]
        );
        assert_eq!(names[6..9], ["k2_standard_error", "k2_from", "k2_to"]);
        assert_eq!(names[15], "k2_constant_noise_error");
        let rows: Vec<_> = reader
            .get_row_iter(None)
            .unwrap()
            .map(Result::unwrap)
            .collect();
        assert_eq!(rows.len(), 6);
        for (i, row) in (0_u32..).zip(&rows) {
            let place = [row.get_long(0).unwrap(), row.get_long(1).unwrap()];
            assert_eq!(place, [i64::from(i / 3), i64::from(i % 3)]);
            let ratio = row.get_double(2).unwrap() / rows[0].get_double(2).unwrap();
            assert!((ratio / f64::from(i + 1) - 1.0).abs() < 1e-9);
        }
    }
}
