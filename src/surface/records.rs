//! Records of text files: values apart by commas, semicolons or blanks, read through the crate `csv`.

use csv::{ReaderBuilder, StringRecord, Terminator, Trim};

/// The values of a line.
#[derive(Debug, PartialEq)]
pub(crate) struct Record {
    /// The line, counted from 1.
    pub line: usize,
    /// The values without outer blanks and quotes; between commas or semicolons they may be empty.
    pub values: Vec<String>,
}

/// The records of a text. Values are apart by semicolons if the text has any, else by commas, else by blanks, and may be in
/// double quotes. Text after `#`, empty lines and a byte order mark are passed over.
pub(crate) fn records(text: &str) -> impl Iterator<Item = Record> {
    let lines = text.trim_start_matches('\u{feff}').lines();
    let content: String = lines.flat_map(content).collect();
    let (content, delimiter) = match [b';', b','].into_iter().find(|&mark| content.contains(char::from(mark))) {
        Some(mark) => (content, mark),
        None => (content.replace('\t', " "), b' '),
    };
    let mut builder = ReaderBuilder::new();
    builder.has_headers(false).flexible(true).trim(Trim::All).terminator(Terminator::Any(b'\n')).delimiter(delimiter);
    let mut reader = builder.from_reader(std::io::Cursor::new(content));
    std::iter::from_fn(move || {
        let mut record = StringRecord::new();
        // Text in memory with any number of values a line has no errors.
        reader.read_record(&mut record).ok().filter(|&found| found)?;
        let values = record.iter().filter(|value| delimiter != b' ' || !value.is_empty()).map(str::to_owned).collect();
        // The reader stands on the next line. Where the record begins, it would count from the empty lines before.
        Some(Record { line: reader.position().line() as usize - 1, values })
    })
}

/// A line up to a `#` that is not in quotes, which end with the line.
fn content(line: &str) -> [&str; 3] {
    let mut quoted = false;
    let end = line.find(|letter| {
        quoted ^= letter == '"';
        letter == '#' && !quoted
    });
    [line[..end.unwrap_or(line.len())].trim(), if quoted { "\"" } else { "" }, "\n"]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<(usize, String)> {
        records(text).map(|Record { line, values }| (line, values.join("|"))).collect()
    }

    #[test]
    fn lines_and_values_are_those_of_the_text() {
        let cases: [(&str, &[(usize, &str)]); 8] = [
            ("1,2\n3,4\n", &[(1, "1|2"), (2, "3|4")]),
            ("\u{feff}\n \n 1 , 2 # a, \"b\n\r\n# c\n3,,4,", &[(3, "1|2"), (6, "3||4|")]),
            ("1;2,5\n3 4;\r\n", &[(1, "1|2,5"), (2, "3 4|")]),
            (" 1  2\t\t3 \n\n\t4\n", &[(1, "1|2|3"), (3, "4")]),
            ("\"x\",\"size, # mm\" # c\n\"1\",2", &[(1, "x|size, # mm"), (2, "1|2")]),
            ("\"a b\" c\n", &[(1, "a b|c")]),
            ("1,\"2,3\n\n4,5", &[(1, "1|2,3"), (3, "4|5")]),
            ("# none\n", &[]),
        ];
        for (text, wanted) in cases {
            let wanted: Vec<_> = wanted.iter().map(|&(line, values)| (line, values.to_owned())).collect();
            assert_eq!(read(text), wanted, "{text:?}");
        }
        assert_ne!(read("\"1,2\",3\n"), read("1,2,3\n"), "quotes hold commas together");
    }
}
