//! The fits as an array of NumPy, whose elements have named fields.

use std::io::{self, Write};

use npyz::{DType, Field, Order, TypeStr, WriterBuilder as _};

use super::array::Cube;
use super::columns::{Column, Values};
use super::fit::PieceFit;

/// Writes the header: an array of the shape of the scans.
pub(super) fn write_header(
    writer: &mut dyn Write,
    cube: &Cube,
    columns: &[Column],
) -> io::Result<()> {
    let order = if cube.fortran_order() {
        Order::Fortran
    } else {
        Order::C
    };
    let fields = columns.iter().map(|column| {
        let dtype = match column {
            Column::Readings => "<u4",
            Column::Status => "|u1",
            _ => "<f8",
        };
        let dtype: TypeStr = dtype.parse().map_err(io::Error::other)?;
        Ok(Field {
            name: column.name(),
            dtype: DType::new_scalar(dtype),
        })
    });
    npyz::WriteOptions::new_header_only()
        .dtype(DType::Record(fields.collect::<io::Result<_>>()?))
        .shape(&cube.scan_shape())
        .order(order)
        .writer(writer)
        .write_header_only()?;
    Ok(())
}

/// Writes the fits of a piece.
pub(super) fn write_rows(
    writer: &mut dyn Write,
    columns: &[Column],
    piece: &PieceFit,
) -> io::Result<()> {
    let values: Vec<Values<'_>> = columns.iter().map(|column| column.values(piece)).collect();
    let mut bytes = Vec::with_capacity(piece.fit.len() * 8 * columns.len());
    for scan in 0..piece.fit.len() {
        for values in &values {
            match values {
                Values::Float(values) => bytes.extend(values[scan].to_le_bytes()),
                Values::Count(counts) => bytes.extend(counts[scan].to_le_bytes()),
                Values::Code(codes) => bytes.push(codes[scan]),
            }
        }
    }
    writer.write_all(&bytes)
}
