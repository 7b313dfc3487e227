//! Letters of 3 x 5 pixels, for labels on pictures.

/// Columns and rows of a letter.
pub const SIZE: [u32; 2] = [3, 5];

/// Rows top to bottom, an octal digit for each: its bits are the pixels, left to right.
const LETTERS: [(char, u16); 43] = [
    ('A', 0o25755),
    ('B', 0o65656),
    ('C', 0o34443),
    ('D', 0o65556),
    ('E', 0o74647),
    ('F', 0o74644),
    ('G', 0o34553),
    ('H', 0o55755),
    ('I', 0o72227),
    ('J', 0o11152),
    ('K', 0o55655),
    ('L', 0o44447),
    ('M', 0o57755),
    ('N', 0o65555),
    ('O', 0o25552),
    ('P', 0o65644),
    ('Q', 0o25573),
    ('R', 0o65655),
    ('S', 0o34216),
    ('T', 0o72222),
    ('U', 0o55557),
    ('V', 0o55552),
    ('W', 0o55775),
    ('X', 0o55255),
    ('Y', 0o55222),
    ('Z', 0o71247),
    ('0', 0o75557),
    ('1', 0o26227),
    ('2', 0o71747),
    ('3', 0o71717),
    ('4', 0o55711),
    ('5', 0o74717),
    ('6', 0o74757),
    ('7', 0o71111),
    ('8', 0o75757),
    ('9', 0o75717),
    ('.', 0o00002),
    ('-', 0o00700),
    (',', 0o00024),
    ('%', 0o51245),
    ('/', 0o11244),
    (':', 0o02020),
    ('+', 0o02720),
];

/// Whether pixel (`x`, `y`) of `letter` is set. Small letters look like capitals; unknown ones are blank.
pub fn is_set(letter: char, x: u32, y: u32) -> bool {
    let rows = LETTERS.iter().find(|(c, _)| *c == letter.to_ascii_uppercase()).map_or(0, |(_, rows)| *rows);
    x < SIZE[0] && y < SIZE[1] && rows >> (3 * (SIZE[1] - 1 - y) + SIZE[0] - 1 - x) & 1 == 1
}
