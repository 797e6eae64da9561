//! The records of a workbook of Excel up to 2003, and the fields and strings in them.

/// A record: its kind, a length of 16 bits, and its data.
#[derive(Debug, Clone, Copy)]
pub(super) struct Record<'a> {
    pub(super) kind: u16,
    data: &'a [u8],
}

impl<'a> Record<'a> {
    pub(super) const FORMULA: u16 = 0x0006;
    pub(super) const EOF: u16 = 0x000a;
    pub(super) const DATE_MODE: u16 = 0x0022;
    pub(super) const FILE_PASS: u16 = 0x002f;
    const CONTINUE: u16 = 0x003c;
    pub(super) const BOUND_SHEET: u16 = 0x0085;
    pub(super) const MUL_RK: u16 = 0x00bd;
    pub(super) const R_STRING: u16 = 0x00d6;
    pub(super) const XF: u16 = 0x00e0;
    pub(super) const MERGE_CELLS: u16 = 0x00e5;
    pub(super) const SST: u16 = 0x00fc;
    pub(super) const LABEL_SST: u16 = 0x00fd;
    pub(super) const NUMBER: u16 = 0x0203;
    pub(super) const LABEL: u16 = 0x0204;
    pub(super) const BOOL_ERR: u16 = 0x0205;
    pub(super) const STRING: u16 = 0x0207;
    pub(super) const RK: u16 = 0x027e;
    pub(super) const FORMAT: u16 = 0x041e;
    pub(super) const BOF: u16 = 0x0809;

    pub(super) fn fields(&self) -> Fields<'a> {
        Fields(self.data)
    }
}

/// The records of a stream from a place on.
pub(super) struct Records<'a> {
    stream: &'a [u8],
    rest: &'a [u8],
}

impl<'a> Records<'a> {
    /// # Errors
    ///
    /// The place is beyond the end.
    pub(super) fn from(stream: &'a [u8], start: usize) -> Result<Self, String> {
        let rest = stream.get(start..);
        let rest = rest.ok_or("is damaged: a sheet is missing")?;
        Ok(Self { stream, rest })
    }

    /// The place behind the last record that was taken.
    pub(super) fn position(&self) -> usize {
        self.stream.len() - self.rest.len()
    }

    /// The next record; `None` at the end of the stream.
    ///
    /// # Errors
    ///
    /// The stream ends within the record.
    pub(super) fn next(&mut self) -> Result<Option<Record<'a>>, String> {
        // Some programs fill the end of the stream.
        if self.rest.len() < 4 {
            return Ok(None);
        }
        let mut fields = Fields(self.rest);
        let (kind, length) = (fields.u16()?, fields.u16()?);
        let data = fields.take(usize::from(length))?;
        self.rest = fields.0;
        Ok(Some(Record { kind, data }))
    }

    /// The data of a record that was taken, and of the records that continue it.
    ///
    /// # Errors
    ///
    /// The stream ends within a record.
    pub(super) fn continued(&mut self, record: &Record<'a>) -> Result<Vec<&'a [u8]>, String> {
        let mut parts = vec![record.data];
        loop {
            let before = self.rest;
            match self.next()? {
                Some(next) if next.kind == Record::CONTINUE => parts.push(next.data),
                _ => {
                    self.rest = before;
                    return Ok(parts);
                }
            }
        }
    }
}

const SHORT: &str = "is damaged: a record of it is too short";

/// The fields of a record, the least significant byte first.
#[derive(Clone, Copy)]
pub(super) struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(SHORT)?;
        self.0 = rest;
        Ok(taken)
    }

    pub(super) fn rest(&self) -> &'a [u8] {
        self.0
    }

    pub(super) fn skip(&mut self, count: usize) -> Result<(), String> {
        self.take(count).map(drop)
    }

    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let taken = self.take(N)?;
        taken.try_into().map_err(|_| SHORT.to_owned())
    }

    pub(super) fn u8(&mut self) -> Result<u8, String> {
        self.array().map(|[byte]| byte)
    }

    pub(super) fn u16(&mut self) -> Result<u16, String> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, String> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn f64(&mut self) -> Result<f64, String> {
        self.array().map(f64::from_le_bytes)
    }
}

/// The data of a record and of those that continue it, with strings that may go on from one to the next.
pub(super) struct Characters<'a> {
    part: &'a [u8],
    others: std::vec::IntoIter<&'a [u8]>,
}

impl<'a> Characters<'a> {
    pub(super) fn of(parts: Vec<&'a [u8]>) -> Self {
        Self {
            part: &[],
            others: parts.into_iter(),
        }
    }

    fn u8(&mut self) -> Result<u8, String> {
        while self.part.is_empty() {
            self.part = self.others.next().ok_or(SHORT)?;
        }
        let (first, rest) = self.part.split_first().ok_or(SHORT)?;
        self.part = rest;
        Ok(*first)
    }

    pub(super) fn u16(&mut self) -> Result<u16, String> {
        Ok(u16::from_le_bytes([self.u8()?, self.u8()?]))
    }

    pub(super) fn u32(&mut self) -> Result<u32, String> {
        let (low, high) = (self.u16()?, self.u16()?);
        Ok(u32::from(high) << 16 | u32::from(low))
    }

    /// Skips bytes, and no more than there are.
    pub(super) fn skip(&mut self, mut count: usize) -> Result<(), String> {
        while count > self.part.len() {
            count -= self.part.len();
            self.part = self.others.next().ok_or(SHORT)?;
        }
        self.part = self.part.get(count..).unwrap_or_default();
        Ok(())
    }

    /// A string of a number of characters, with its flags before it.
    pub(super) fn text(&mut self, length: usize) -> Result<String, String> {
        if length == 0 {
            return Ok(String::new());
        }
        let flags = self.u8()?;
        self.characters(length, flags)
    }

    /// A string that may have formats and phonetic signs behind it, which are skipped.
    pub(super) fn rich_text(&mut self, length: usize) -> Result<String, String> {
        let flags = self.u8()?;
        let formats = if flags & 8 == 0 { 0 } else { self.u16()? };
        let phonetic = if flags & 4 == 0 { 0 } else { self.u32()? };
        let text = self.characters(length, flags)?;
        self.skip(4 * usize::from(formats))?;
        self.skip(usize::try_from(phonetic).map_err(|_| SHORT)?)?;
        Ok(text)
    }

    /// Characters in UTF-16, of which all upper bytes may be left out. A part that continues a string
    /// begins with a byte that says whether they are.
    fn characters(&mut self, length: usize, flags: u8) -> Result<String, String> {
        let mut wide = flags & 1 != 0;
        let mut units: Vec<u16> = Vec::new();
        while units.len() < length {
            if self.part.is_empty() {
                wide = self.u8()? & 1 != 0;
                continue;
            }
            let low = self.u8()?;
            let high = if wide { self.u8()? } else { 0 };
            units.push(u16::from_le_bytes([low, high]));
        }
        Ok(String::from_utf16_lossy(&units))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_string_goes_on_in_the_next_part_with_other_widths() {
        let parts: Vec<&[u8]> = vec![b"\x04\0\0ab", b"\x01c\0\xac\x20", b"\x02\0\0xy"];
        let mut characters = Characters::of(parts);
        let length = characters.u16().unwrap();
        assert_eq!(characters.rich_text(length.into()).unwrap(), "abc\u{20ac}");
        let length = characters.u16().unwrap();
        assert_eq!(characters.text(length.into()).unwrap(), "xy");
        assert!(characters.u16().unwrap_err().contains("too short"));
    }

    #[test]
    fn formats_and_phonetic_signs_of_a_string_are_skipped() {
        let parts: Vec<&[u8]> = vec![b"\x0c\x01\0\x03\0\0\0ab1234", b"567\x01\0\0z"];
        let mut characters = Characters::of(parts.clone());
        assert_eq!(characters.rich_text(2).unwrap(), "ab");
        assert_eq!(characters.u16().unwrap(), 1);
        assert_eq!(characters.text(1).unwrap(), "z");
        assert!(Characters::of(parts).skip(100).is_err());
    }

    #[test]
    fn records_are_taken_one_after_the_other_with_what_continues_them() {
        let stream = b"\xfc\0\x02\0ab\x3c\0\x01\0c\x3c\0\0\0\x0a\0\0\0\0";
        let mut records = Records::from(stream, 0).unwrap();
        let record = records.next().unwrap().unwrap();
        assert_eq!(record.kind, Record::SST);
        let parts = records.continued(&record).unwrap();
        assert_eq!(parts, [b"ab".as_slice(), b"c", b""]);
        assert_eq!(records.next().unwrap().unwrap().kind, Record::EOF);
        assert!(records.next().unwrap().is_none());
        assert!(Records::from(stream, 100).is_err());
        let cut = Records::from(b"\xfc\0\x02\0a", 0).unwrap().next();
        assert!(cut.unwrap_err().contains("too short"));
    }
}
