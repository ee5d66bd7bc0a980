//! The boxes of an MP4 film with one stream of H.264 (ISO/IEC 14496-12 and 14496-15).
//!
//! The index (`moov`) stands before the pictures, so that a browser plays what it has of the file. Its length follows from the number of
//! frames, of key frames and of bytes in the parameter sets alone: room is left for it, and it is written last.

use super::frames::Rate;

/// Everything that the index says.
#[derive(Debug)]
pub struct Index<'a> {
    /// Width and height [pixels].
    pub size: [u32; 2],
    /// Frames a second.
    pub rate: Rate,
    /// The sequence parameter set, with its header and without a start code.
    pub sequence: &'a [u8],
    /// The picture parameter set, likewise.
    pub picture: &'a [u8],
    /// The length of each frame [bytes].
    pub lengths: &'a [u32],
    /// Which frames can be decoded by themselves, counted from 1.
    pub keys: &'a [u32],
}

/// A box: its length, its name, what is in it.
fn named(name: &[u8; 4], parts: &[&[u8]]) -> Vec<u8> {
    let inside: usize = parts.iter().map(|part| part.len()).sum();
    let mut bytes = ((8 + inside) as u32).to_be_bytes().to_vec();
    bytes.extend(name);
    bytes.extend(parts.iter().copied().flatten());
    bytes
}

/// Big-endian numbers of 32 bits.
fn words(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_be_bytes()).collect()
}

/// Rotations that are none, 16.16 and 2.30.
const UPRIGHT: [u32; 9] = [0x1_0000, 0, 0, 0, 0x1_0000, 0, 0, 0, 0x4000_0000];

/// Ticks of the clock that says how long the film is [1/s].
const CLOCK: u32 = 1000;

impl Index<'_> {
    /// The beginning of the file: its brands, the index, and the head of the box that holds the pictures, which follow at once.
    pub fn bytes(&self) -> Vec<u8> {
        let brands = named(b"ftyp", &[b"isom", &words(&[0x200]), b"isomiso2avc1mp41"]);
        // Once to learn how long it is, once to say where the pictures begin.
        let length = |start| brands.len() + self.moov(start).len() + 16;
        let start = length(0) as u64;
        let inside: u64 = self.lengths.iter().map(|&n| u64::from(n)).sum();
        // A length of 1 says that a longer number follows.
        let mut data = words(&[1]);
        data.extend(b"mdat");
        data.extend((16 + inside).to_be_bytes());
        [brands, self.moov(start), data].concat()
    }

    /// The index of pictures that begin at a place of the file.
    fn moov(&self, start: u64) -> Vec<u8> {
        let [rate, seconds] = self.rate.fraction();
        let count = self.lengths.len() as u64;
        let length = count * u64::from(seconds);
        let shown = (length * u64::from(CLOCK)).div_ceil(u64::from(rate));
        let long = |n: u64| n.to_be_bytes();
        let mvhd = named(
            b"mvhd",
            &[
                &words(&[0x0100_0000, 0, 0, 0, 0, CLOCK]),
                &long(shown),
                // Speed, loudness, two reserved words.
                &words(&[0x1_0000, 0x0100_0000, 0, 0]),
                &words(&UPRIGHT),
                &words(&[0, 0, 0, 0, 0, 0, 2]),
            ],
        );
        let tkhd = named(
            b"tkhd",
            &[
                // Enabled, in the film; created and changed at no time; the first track.
                &words(&[0x0100_0003, 0, 0, 0, 0, 1, 0]),
                &long(shown),
                &words(&[0, 0, 0, 0]),
                &words(&UPRIGHT),
                &words(&self.size.map(|side| side << 16)),
            ],
        );
        let mdhd = named(
            b"mdhd",
            &[
                &words(&[0x0100_0000, 0, 0, 0, 0, rate]),
                &long(length),
                // No language.
                &words(&[0x55c4_0000]),
            ],
        );
        let hdlr = named(
            b"hdlr",
            &[&words(&[0, 0]), b"vide", &words(&[0, 0, 0]), b"film\0"],
        );
        let vmhd = named(b"vmhd", &[&words(&[1, 0, 0])]);
        let here = named(b"url ", &[&words(&[1])]);
        let dinf = named(b"dinf", &[&named(b"dref", &[&words(&[0, 1]), &here])]);
        let stbl = named(
            b"stbl",
            &[
                &named(b"stsd", &[&words(&[0, 1]), &self.avc1()]),
                &named(b"stts", &[&words(&[0, 1, count as u32, seconds])]),
                &self.table(b"stss", &[], self.keys),
                // All frames in one run of bytes.
                &named(b"stsc", &[&words(&[0, 1, 1, count as u32, 1])]),
                &self.table(b"stsz", &[0], self.lengths),
                &named(b"co64", &[&words(&[0, 1]), &long(start)]),
            ],
        );
        let minf = named(b"minf", &[&vmhd, &dinf, &stbl]);
        let mdia = named(b"mdia", &[&mdhd, &hdlr, &minf]);
        let trak = named(b"trak", &[&tkhd, &mdia]);
        named(b"moov", &[&mvhd, &trak])
    }

    /// A table of numbers after its flags, what stands before their count, and their count.
    fn table(&self, name: &[u8; 4], before: &[u32], numbers: &[u32]) -> Vec<u8> {
        let count = words(&[numbers.len() as u32]);
        named(
            name,
            &[&words(&[0]), &words(before), &count, &words(numbers)],
        )
    }

    /// How the stream is coded and what its colours are.
    fn avc1(&self) -> Vec<u8> {
        let set = |set: &[u8]| [&(set.len() as u16).to_be_bytes(), set].concat();
        let profile = self.sequence.get(1..4).unwrap_or(&[66, 0, 10]);
        let avcc = named(
            b"avcC",
            &[
                // Lengths of four bytes; one set of each kind.
                &[1],
                profile,
                &[0xff, 0xe1],
                &set(self.sequence),
                &[1],
                &set(self.picture),
            ],
        );
        // Primaries, transfer and matrix of BT.709, limited range.
        let colr = named(b"colr", &[b"nclx", &[0, 1, 0, 1, 0, 1, 0]]);
        let pasp = named(b"pasp", &[&words(&[1, 1])]);
        let [width, height] = self.size;
        named(
            b"avc1",
            &[
                &words(&[0, 1, 0, 0, 0, 0]),
                &words(&[width << 16 | height]),
                // 72 pixels an inch, one frame a sample, no name, 24 bits without alpha.
                &words(&[0x48_0000, 0x48_0000, 0]),
                &[0, 1],
                &[0; 32],
                &[0, 24, 0xff, 0xff],
                &avcc,
                &colr,
                &pasp,
            ],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The boxes side by side in `bytes`: name, inside.
    fn boxes(mut bytes: &[u8]) -> Vec<(String, &[u8])> {
        let mut found = Vec::new();
        while bytes.len() >= 8 {
            let length = u32::from_be_bytes(bytes[..4].try_into().unwrap()) as usize;
            let name = String::from_utf8_lossy(&bytes[4..8]).into_owned();
            let length = if length == 1 { bytes.len() } else { length };
            found.push((name, &bytes[8..length]));
            bytes = &bytes[length..];
        }
        assert!(bytes.is_empty());
        found
    }

    fn inside<'a>(bytes: &'a [u8], path: &[&str]) -> &'a [u8] {
        let mut bytes = bytes;
        for name in path {
            let found = boxes(bytes).into_iter().find(|(found, _)| found == name);
            bytes = found.unwrap_or_else(|| panic!("no {name}")).1;
        }
        bytes
    }

    #[test]
    fn the_index_leads_to_the_pictures_whatever_its_numbers() {
        let sequence = [0x67, 66, 0x40, 30, 1, 2, 3];
        let lengths = [70_000, 3, 5];
        let index = Index {
            size: [322, 200],
            rate: Rate::new(24_000, 1001).unwrap(),
            sequence: &sequence,
            picture: &[0x68, 9],
            lengths: &lengths,
            keys: &[1, 3],
        };
        let bytes = index.bytes();
        let names: Vec<_> = boxes(&bytes).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["ftyp", "moov", "mdat"]);
        // Room is left for it before the numbers are known.
        let empty = Index {
            lengths: &[0; 3],
            keys: &[0; 2],
            ..index
        };
        assert_eq!(empty.bytes().len(), bytes.len());
        let table = ["moov", "trak", "mdia", "minf", "stbl"];
        let of = |name: &str| inside(inside(&bytes, &table), &[name]).to_vec();
        assert_eq!(of("co64")[8..], (bytes.len() as u64).to_be_bytes());
        assert_eq!(of("stsz")[4..], words(&[0, 3, 70_000, 3, 5]));
        assert_eq!(of("stss")[4..], words(&[2, 1, 3]));
        assert_eq!(of("stts")[4..], words(&[1, 3, 1001]));
        // Three frames are 125 milliseconds and an eighth.
        let mvhd = inside(&bytes, &["moov", "mvhd"]);
        assert_eq!(
            mvhd[20..32],
            [words(&[1000]), 126_u64.to_be_bytes().to_vec()].concat()
        );
        // 78 bytes of a visual sample, after the eight of the table and the eight of the box.
        let entry = &of("stsd")[16..];
        assert_eq!(entry[24..28], [1, 66, 0, 200]);
        assert_eq!(inside(&entry[78..], &["colr"]), b"nclx\0\x01\0\x01\0\x01\0");
        let configuration = inside(&entry[78..], &["avcC"]);
        assert_eq!(configuration[..6], [1, 66, 0x40, 30, 0xff, 0xe1]);
        assert_eq!(configuration[6..15], [0, 7, 0x67, 66, 0x40, 30, 1, 2, 3]);
        assert_eq!(configuration[15..], [1, 0, 2, 0x68, 9]);
    }
}
