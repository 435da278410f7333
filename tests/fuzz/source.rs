//! Random values, good and bad, from a seed.

/// Numbers that programs stumble over.
const WILD: [f64; 24] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    f64::MIN_POSITIVE,
    5e-324,
    -5e-324,
    f64::EPSILON,
    1e-200,
    1e200,
    1e-90,
    1e90,
    1e-30,
    1e30,
    1e16,
    9007199254740993.0,
    4294967296.0,
    0.5,
    -1e-9,
];

/// A stream of numbers from splitmix64.
#[derive(Debug, Clone)]
pub struct Source {
    state: u64,
    /// The share of numbers that may be anything.
    wildness: f64,
}

/// The next state and output of splitmix64.
pub fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl Source {
    /// Half of the cases are sane, so that they get far; the others more or less wild.
    pub fn new(seed: u64) -> Source {
        let mut source = Source { state: seed, wildness: 0.0 };
        source.wildness = source.choose(&[0.0, 0.0, 0.0, 0.02, 0.1, 0.5]);
        source
    }

    pub fn u64(&mut self) -> u64 {
        split_mix(&mut self.state)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.u64() % n.max(1) as u64) as usize
    }

    /// From `low` to `high`, both included.
    pub fn count(&mut self, low: usize, high: usize) -> usize {
        low + self.below(high - low + 1)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }

    pub fn choose<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }

    /// Anything at all.
    pub fn anything(&mut self) -> f64 {
        match self.below(3) {
            0 => f64::from_bits(self.u64()),
            1 => self.choose(&WILD),
            _ => {
                let size = 10f64.powf(-320.0 + 640.0 * self.unit());
                if self.chance(0.3) { -size } else { size }
            }
        }
    }

    /// Log-uniform between two positive numbers, or now and then anything.
    pub fn scale(&mut self, low: f64, high: f64) -> f64 {
        if self.chance(self.wildness) { self.anything() } else { low * (high / low).powf(self.unit()) }
    }

    /// Uniform between two numbers, or now and then anything.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        if self.chance(self.wildness) { self.anything() } else { low + (high - low) * self.unit() }
    }

    pub fn bytes(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.u64() as u8).collect()
    }

    /// Damages a text as slips of hand and odd programs do, so that much of it is still accepted: digits, numbers and whole
    /// lines are changed, exchanged, repeated or lost.
    pub fn damage_text(&mut self, file: &[u8]) -> Vec<u8> {
        const NUMBERS: [&[u8]; 14] =
            [b"0", b"-0", b"1", b"-1", b"2", b"3", b"1e-9", b"0.5", b"1e300", b"5e-324", b"1e9", b"7", b".5", b"+4"];
        let mut file = file.to_vec();
        let slips = self.choose(&[1, 1, 1, 2, 4]);
        for _ in 0..slips {
            let digits: Vec<usize> = (0..file.len()).filter(|&k| file[k].is_ascii_digit()).collect();
            let ends: Vec<usize> = (0..file.len()).filter(|&k| file[k] == b'\n').map(|k| k + 1).collect();
            if file.is_empty() || digits.is_empty() {
                break;
            }
            let at = self.choose(&digits);
            // lines from one of their beginnings to the next
            let line = |start: usize| start..ends.iter().copied().find(|&end| end > start).unwrap_or(file.len());
            let begin = |at: usize| ends.iter().copied().filter(|&end| end <= at).max().unwrap_or(0);
            match self.below(10) {
                0..=4 => file[at] = b"0123456789"[self.below(10)],
                5 | 6 => {
                    let is_part = |byte: u8| byte.is_ascii_digit() || b"+-.eE".contains(&byte);
                    let first = (0..at).rev().take_while(|&k| is_part(file[k])).last().unwrap_or(at);
                    let last = (at..file.len()).take_while(|&k| is_part(file[k])).last().unwrap_or(at);
                    let number = self.choose(&NUMBERS);
                    file.splice(first..=last, number.iter().copied());
                }
                7 => {
                    let piece = file[line(begin(at))].to_vec();
                    let to = begin(self.below(file.len()));
                    file.splice(to..to, piece);
                }
                8 => drop(file.drain(line(begin(at)))),
                _ => {
                    let blank = self.choose(&[b" ", b"\t", b"\r", b"\n"]);
                    file.insert(at, blank[0]);
                }
            }
        }
        file
    }

    /// Damages a file whose head is text or numbers of `head` bytes: mostly what comes after it, so that it is accepted as
    /// often as not; now and then anything.
    pub fn damage_behind(&mut self, file: &[u8], head: usize) -> Vec<u8> {
        if head >= file.len() || self.chance(0.4) {
            return self.damage(file);
        }
        let mut file = file.to_vec();
        for _ in 0..=self.below(6) {
            let at = self.count(head, file.len() - 1);
            match self.below(3) {
                0 => file[at] = self.u64() as u8,
                1 => file[at] ^= 1 << self.below(8),
                _ => {
                    let number = self.anything().to_le_bytes();
                    file[at..].iter_mut().zip(number).for_each(|(byte, new)| *byte = new);
                }
            }
        }
        file
    }

    /// Damages a file: a few bytes cut, turned, repeated, or replaced by what stands in files.
    pub fn damage(&mut self, file: &[u8]) -> Vec<u8> {
        const WORDS: &str =
            "nan inf -1 0 1e308 -1e-320 18446744073709551615 4294967296 65536 2147483647 -0 1e999 , < 0.1";
        let words = WORDS.split(' ').map(str::as_bytes);
        let tokens: Vec<&[u8]> = words.chain([b"\n" as &[u8], b"\0", b"\xff\xff\xff\xff"]).collect();
        let mut file = file.to_vec();
        for _ in 0..=self.below(4) {
            if file.is_empty() {
                break;
            }
            let at = self.below(file.len());
            match self.below(8) {
                0 => file.truncate(at),
                1 => file.insert(at, self.u64() as u8),
                2 => drop(file.remove(at)),
                3 => file[at] = self.u64() as u8,
                4 => file[at] ^= 1 << self.below(8),
                5 => {
                    let end = (at + self.count(1, 12)).min(file.len());
                    let piece = file[at..end].to_vec();
                    let to = self.below(file.len());
                    file.splice(to..to, piece);
                }
                6 => {
                    let token = self.choose(&tokens);
                    let end = (at + self.below(token.len() + 1)).min(file.len());
                    file.splice(at..end, token.iter().copied());
                }
                _ => {
                    let end = (at + self.count(1, 9)).min(file.len());
                    file.drain(at..end);
                }
            }
        }
        file
    }
}
