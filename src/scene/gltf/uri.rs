//! URIs as they stand in glTF files: `data:` (RFC 2397) in all its forms, and names of files (RFC 3986).

use std::borrow::Cow;
use std::path::{Component, Path, PathBuf};

/// The octets of a `data:` URI; `None` for another URI. The error says what is wrong with it.
///
/// Scheme, parameters and base64 are read in either case, percent-encoded or not, with or without padding and line breaks,
/// and in the alphabet of URLs as well (RFC 4648, section 5).
pub(super) fn data(uri: &str) -> Option<Result<Vec<u8>, &'static str>> {
    let uri = uri.trim();
    if !uri.get(..5)?.eq_ignore_ascii_case("data:") {
        return None;
    }
    let Some((header, body)) = uri[5..].split_once(',') else {
        return Some(Err("the data: URI has no comma, so that nothing is in it"));
    };
    let body = percent_decode(body);
    let is_base64 = |part: &str| part.trim().eq_ignore_ascii_case("base64");
    Some(if header.split(';').skip(1).any(is_base64) {
        decode_base64(&body).ok_or("the data: URI is not base64")
    } else {
        Ok(body.into_owned())
    })
}

/// The file that a URI names, relative to its scene's folder or absolute; `None` when it is on the net or no name at all.
pub(super) fn file(uri: &str) -> Option<PathBuf> {
    let scheme = uri.split_once("://").map(|(scheme, _)| scheme);
    let name = match scheme {
        Some(scheme) if scheme.eq_ignore_ascii_case("file") => {
            let rest = &uri[scheme.len() + 3..];
            rest.strip_prefix("localhost").unwrap_or(rest)
        }
        Some(_) => return None,
        None => uri,
    };
    let name = String::from_utf8(percent_decode(name).into_owned()).ok()?;
    (!name.is_empty() && !name.contains('\0')).then(|| PathBuf::from(name))
}

/// Whether a name leads out of the folder that it starts in, by its own words.
pub(super) fn leads_out(name: &Path) -> bool {
    let mut depth = 0i64;
    name.components().any(|part| {
        match part {
            Component::Normal(_) => depth += 1,
            Component::ParentDir => depth -= 1,
            Component::CurDir => {}
            Component::RootDir | Component::Prefix(_) => return true,
        }
        depth < 0
    })
}

fn decode_base64(text: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut held, mut padded) = (0u32, 0, false);
    for &c in text.iter().filter(|c| !c.is_ascii_whitespace()) {
        let six = match c {
            b'=' => {
                padded = true;
                continue;
            }
            _ if padded => return None,
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(six);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    // Six bits alone are no octet: a character is missing.
    (held < 6).then_some(bytes)
}

/// Percent signs that no two hexadecimal digits follow stay as they are.
fn percent_decode(text: &str) -> Cow<'_, [u8]> {
    if !text.contains('%') {
        return Cow::Borrowed(text.as_bytes());
    }
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&c, tail)) = rest.split_first() {
        let digit = |at: usize| (*tail.get(at)? as char).to_digit(16);
        let code = match (c, digit(0), digit(1)) {
            (b'%', Some(high), Some(low)) => Some((16 * high + low) as u8),
            _ => None,
        };
        bytes.push(code.unwrap_or(c));
        rest = if code.is_some() { &tail[2..] } else { tail };
    }
    Cow::Owned(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_and_percent_signs() {
        // RFC 4648, section 10; without padding as well.
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zg", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9v\r\n YmFy", "foobar"),
        ] {
            assert_eq!(decode_base64(text.as_bytes()).unwrap(), bytes.as_bytes());
        }
        assert_eq!(decode_base64(b"-_8"), decode_base64(b"+/8="));
        for bad in ["Zm9*", "Zg==Zg", "Z"] {
            assert_eq!(decode_base64(bad.as_bytes()), None, "{bad}");
        }
        assert_eq!(*percent_decode("a%20b%C3%A9%"), *"a bé%".as_bytes());
        assert_eq!(*percent_decode("%+1%"), *b"%+1%");
    }

    #[test]
    fn data_uris_in_every_form() {
        for uri in [
            "data:application/octet-stream;base64,Zm9v",
            "DATA:application/octet-stream;BASE64,Zm9v",
            "data:;base64,Zm9v",
            "data:text/plain;charset=utf-8;base64,Zm9v",
            "data:text/plain; base64,Zm%39v",
            "data:,foo",
            "data:text/plain,f%6Fo",
            " data:base64,foo",
        ] {
            assert_eq!(data(uri), Some(Ok(b"foo".to_vec())), "{uri}");
        }
        assert!(matches!(data("data:;base64"), Some(Err(_))));
        assert!(matches!(data("data:;base64,Zm9v*"), Some(Err(_))));
        assert_eq!(data("data.bin"), None);
        assert_eq!(data("é"), None);
    }

    #[test]
    fn names_of_files() {
        for (uri, name) in [
            ("a%20b.bin", Some("a b.bin")),
            ("file:///tmp/a.bin", Some("/tmp/a.bin")),
            ("FILE://localhost/tmp/a.bin", Some("/tmp/a.bin")),
            ("https://example.org/a.bin", None),
            ("%FF", None),
            ("", None),
        ] {
            assert_eq!(file(uri), name.map(PathBuf::from), "{uri}");
        }
        for (name, out) in [
            ("a/../b", false),
            ("./a", false),
            ("../a", true),
            ("a/../../b/c", true),
            ("/etc/passwd", true),
        ] {
            assert_eq!(leads_out(Path::new(name)), out, "{name}");
        }
    }
}
