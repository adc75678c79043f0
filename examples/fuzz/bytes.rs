//! Random numbers, and what is done to bytes with them.

/// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Below `end`; 0 if that is 0.
    pub fn below(&mut self, end: usize) -> usize {
        if end == 0 { 0 } else { (self.next() % end as u64) as usize }
    }

    pub fn one_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    pub fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }
}

/// Longest input.
pub const MOST: usize = 1 << 16;

const ODD: &[u64] = &[
    0,
    1,
    2,
    0x7f,
    0x80,
    0xff,
    0x100,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x1_0000_0000,
    0x7fff_ffff_ffff_ffff,
    0x8000_0000_0000_0000,
    u64::MAX,
    0x7ff0_0000_0000_0000,
    0x7ff8_0000_0000_0000,
    0x7fef_ffff_ffff_ffff,
];

/// Does one to eight small things to bytes. `words` are of the format, `others` other inputs.
pub fn havoc(random: &mut Random, bytes: &mut Vec<u8>, words: &[Vec<u8>], others: &[Vec<u8>]) {
    for _ in 0..1 << random.below(4) {
        one(random, bytes, words, others);
    }
    bytes.truncate(MOST);
}

fn one(random: &mut Random, bytes: &mut Vec<u8>, words: &[Vec<u8>], others: &[Vec<u8>]) {
    let length = bytes.len();
    let at = random.below(length);
    let some = |random: &mut Random| (1 << random.below(9)).min(length - at);
    match random.below(11) {
        0 | 1 if length > 0 => bytes[at] ^= 1 << random.below(8),
        2 if length > 0 => bytes[at] = random.next() as u8,
        3 if length > 0 => {
            let width = 1 << random.below(4);
            let odd = random.of(ODD).wrapping_add(random.below(3) as u64).wrapping_sub(1);
            put(bytes, at, &odd.to_le_bytes()[..width]);
        }
        4 if length > 0 => drop(bytes.drain(at..at + some(random))),
        5 if length > 0 => {
            let piece = bytes[at..at + some(random)].to_vec();
            let times = if random.one_in(8) { 1 + random.below(200) } else { 1 };
            let to = random.below(length);
            drop(bytes.splice(to..to, piece.repeat(times)));
        }
        6 if length > 0 => {
            let piece = bytes[at..at + some(random)].to_vec();
            let to = random.below(length);
            put(bytes, to, &piece);
        }
        7 | 8 if !words.is_empty() => {
            let word = random.of(words).clone();
            match random.one_in(2) && length > 0 {
                true => put(bytes, at, &word),
                false => drop(bytes.splice(at..at, word)),
            }
        }
        9 if !others.is_empty() => {
            let other = random.of(others);
            let from = random.below(other.len());
            let piece = &other[from..(from + (1 << random.below(12))).min(other.len())];
            drop(bytes.splice(at..at, piece.iter().copied()));
        }
        _ => {
            let cut = if random.one_in(16) { at } else { length };
            bytes.truncate(cut);
            bytes.push(random.next() as u8);
        }
    }
}

fn put(bytes: &mut [u8], at: usize, piece: &[u8]) {
    let end = (at + piece.len()).min(bytes.len());
    bytes[at..end].copy_from_slice(&piece[..end - at]);
}

/// Numbers of a text become odd ones, and lines and words change places.
pub fn text(random: &mut Random, bytes: &mut Vec<u8>) {
    const NUMBERS: &[&str] = &[
        "0",
        "-0",
        "1",
        "-1",
        "nan",
        "inf",
        "-inf",
        "1e308",
        "1e-320",
        "1e400",
        "64",
        "1e12",
        "99999999999999999999",
        "0.0000001",
        "1e",
        "+1",
        ".5",
        "5.",
        "0x10",
        "1_000",
        "true",
        "\"\"",
        "[]",
        "{}",
        "1e300",
        "-1e9",
        "4294967296",
        "3.0",
    ];
    let number = |b: &u8| b.is_ascii_digit() || *b == b'.' || *b == b'-';
    let starts: Vec<usize> = (0..bytes.len())
        .filter(|k| number(&bytes[*k]) && (*k == 0 || !number(&bytes[k - 1])))
        .collect();
    if starts.is_empty() {
        return;
    }
    let start = *random.of(&starts);
    let end = start + bytes[start..].iter().take_while(|b| number(b)).count();
    drop(bytes.splice(start..end, random.of(NUMBERS).bytes()));
}

/// Names and numbers of texts, each once.
pub fn words_of(texts: &[Vec<u8>]) -> Vec<Vec<u8>> {
    let word = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_';
    let mut words: Vec<Vec<u8>> = Vec::new();
    for text in texts {
        words.extend(text.split(|b| !word(b)).filter(|w| w.len() > 1).map(<[u8]>::to_vec));
    }
    words.sort();
    words.dedup();
    words
}
