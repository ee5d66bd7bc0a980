//! Words in pictures: Hershey's letters, which are strokes and need no font.

use super::canvas::{Canvas, Color};

/// Where a text's anchor lies in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// At its left end.
    Start,
    /// In its middle.
    Middle,
    /// At its right end.
    End,
}

/// Writes a text of a size [pixels] onto a picture, centred in height on its anchor (x to the right, y down), with a halo around it if
/// one is given. What lies beside the picture is cut off.
pub fn draw_text(
    canvas: &mut Canvas,
    at: [f64; 2],
    text: &str,
    size: f64,
    anchor: Anchor,
    color: Color,
    halo: Option<Color>,
) {
    let strokes = letters(text, at, size, anchor);
    if let Some(halo) = halo {
        canvas.stroke(&strokes, 0.42 * size, halo);
    }
    canvas.stroke(&strokes, 0.095 * size, color);
}

/// The width of a text of a size, in the size's unit.
pub fn text_width(text: &str, size: f64) -> f64 {
    let units = |g: &str| f64::from(g.as_bytes()[1]) - f64::from(g.as_bytes()[0]);
    text.chars().map(|c| units(glyph(c))).sum::<f64>() * 0.72 * size / 21.0
}

/// The strokes of a text in Hershey's letters.
pub fn letters(text: &str, at: [f64; 2], size: f64, anchor: Anchor) -> Vec<Vec<[f64; 2]>> {
    // Capitals are 21 units high, from -12 to 9, and 0.72 of the size.
    let scale = 0.72 * size / 21.0;
    let glyphs: Vec<&str> = text.chars().map(glyph).collect();
    let side = |byte: u8| f64::from(byte) - 82.0;
    let width = text_width(text, size);
    let mut x = at[0]
        - match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
    let mut strokes = Vec::new();
    for glyph in glyphs {
        let bytes = glyph.as_bytes();
        let left = side(bytes[0]);
        let mut stroke = Vec::new();
        for pair in bytes[2..].chunks_exact(2) {
            if pair == b" R" {
                strokes.push(std::mem::take(&mut stroke));
            } else {
                stroke.push([
                    x + (side(pair[0]) - left) * scale,
                    at[1] + (side(pair[1]) + 1.5) * scale,
                ]);
            }
        }
        strokes.push(stroke);
        x += (side(bytes[1]) - left) * scale;
    }
    strokes.retain(|stroke| stroke.len() > 1);
    strokes
}

/// A letter's strokes: the left and right side, then points, each two letters of which R is zero; " R" lifts the pen.
fn glyph(c: char) -> &'static str {
    match c {
        '°' => "KXQFOGNINKOMQNSNUMVKVIUGSFQF",
        '\u{2212}' => GLYPHS[usize::from(b'-' - b' ')],
        _ => u32::from(c)
            .checked_sub(32)
            .and_then(|i| GLYPHS.get(i as usize))
            .copied()
            .unwrap_or(GLYPHS[usize::from(b'?' - b' ')]),
    }
}

/// The letters from space to tilde: the simplex Roman of A. V. Hershey (US National Bureau of Standards, 1967).
#[rustfmt::skip]
const GLYPHS: [&str; 95] = [
    "JZ", "MWRFRT RRYQZR[SZRY", "JZNFNM RVFVM", "H]SBLb RYBRb RLOZO RKUYU",
    "H\\PBP_ RTBT_ RYIWGTFPFMGKIKKLMMNOOUQWRXSYUYXWZT[P[MZKX",
    "F^[FI[ RNFPHPJOLMMKMIKIIJGLFNFPGSHVHYG[F RWTUUTWTYV[X[ZZ[X[VYTWT",
    "E_\\O\\N[MZMYNXPVUTXRZP[L[JZIYHWHUISJRQNRMSKSIRGPFNGMIMKNNPQUXWZY[[[\\Z\\Y", "MWRHQGRFSGSIRKQL",
    "KYVBTDRGPKOPOTPYR]T`Vb", "KYNBPDRGTKUPUTTYR]P`Nb", "JZRLRX RMOWU RWOMU", "E_RIR[ RIR[R", "NVSWRXQWRVSWSYQ[",
    "E_IR[R", "NVRVQWRXSWRV", "G][BIb", "H\\QFNGLJKOKRLWNZQ[S[VZXWYRYOXJVGSFQF", "H\\NJPISFS[",
    "H\\LKLJMHNGPFTFVGWHXJXLWNUQK[Y[", "H\\MFXFRNUNWOXPYSYUXXVZS[P[MZLYKW", "H\\UFKTZT RUFU[",
    "H\\WFMFLOMNPMSMVNXPYSYUXXVZS[P[MZLYKW", "H\\XIWGTFRFOGMJLOLTMXOZR[S[VZXXYUYTXQVOSNRNOOMQLT", "H\\YFO[ RKFYF",
    "H\\PFMGLILKMMONSOVPXRYTYWXYWZT[P[MZLYKWKTLRNPQOUNWMXKXIWGTFPF",
    "H\\XMWPURRSQSNRLPKMKLLINGQFRFUGWIXMXRWWUZR[P[MZLX", "NVROQPRQSPRO RRVQWRXSWRV", "NVROQPRQSPRO RSWRXQWRVSWSYQ[",
    "F^ZIJRZ[", "E_IO[O RIU[U", "F^JIZRJ[", "I[LKLJMHNGPFTFVGWHXJXLWNVORQRT RRYQZR[SZRY",
    "E`WNVLTKQKOLNMMPMSNUPVSVUUVS RQKOMNPNSOUPV RWKVSVUXVZV\\T]Q]O\\L[JYHWGTFQFNGLHJJILHOHRIUJWLYNZQ[T[WZYYZX RXKWSWUXV",
    "I[RFJ[ RRFZ[ RMTWT", "G\\KFK[ RKFTFWGXHYJYLXNWOTP RKPTPWQXRYTYWXYWZT[K[",
    "H]ZKYIWGUFQFOGMILKKNKSLVMXOZQ[U[WZYXZV", "G\\KFK[ RKFRFUGWIXKYNYSXVWXUZR[K[", "H[LFL[ RLFYF RLPTP RL[Y[",
    "HZLFL[ RLFYF RLPTP", "H]ZKYIWGUFQFOGMILKKNKSLVMXOZQ[U[WZYXZVZS RUSZS", "G]KFK[ RYFY[ RKPYP", "NVRFR[",
    "JZVFVVUYTZR[P[NZMYLVLT", "G\\KFK[ RYFKT RPOY[", "HYLFL[ RL[X[", "F^JFJ[ RJFR[ RZFR[ RZFZ[",
    "G]KFK[ RKFY[ RYFY[", "G]PFNGLIKKJNJSKVLXNZP[T[VZXXYVZSZNYKXIVGTFPF", "G\\KFK[ RKFTFWGXHYJYMXOWPTQKQ",
    "G]PFNGLIKKJNJSKVLXNZP[T[VZXXYVZSZNYKXIVGTFPF RSWY]", "G\\KFK[ RKFTFWGXHYJYLXNWOTPKP RRPY[",
    "H\\YIWGTFPFMGKIKKLMMNOOUQWRXSYUYXWZT[P[MZKX", "JZRFR[ RKFYF", "G]KFKULXNZQ[S[VZXXYUYF", "I[JFR[ RZFR[",
    "F^HFM[ RRFM[ RRFW[ R\\FW[", "H\\KFY[ RYFK[", "I[JFRPR[ RZFRP", "H\\YFK[ RKFYF RK[Y[",
    "KYOBOb RPBPb ROBVB RObVb", "KYKFY^", "KYTBTb RUBUb RNBUB RNbUb", "JZRDJR RRDZR", "I[Ib[b", "NVSKQMQORPSORNQO",
    "I\\XMX[ RXPVNTMQMONMPLSLUMXOZQ[T[VZXX", "H[LFL[ RLPNNPMSMUNWPXSXUWXUZS[P[NZLX",
    "I[XPVNTMQMONMPLSLUMXOZQ[T[VZXX", "I\\XFX[ RXPVNTMQMONMPLSLUMXOZQ[T[VZXX",
    "I[LSXSXQWOVNTMQMONMPLSLUMXOZQ[T[VZXX", "MYWFUFSGRJR[ ROMVM", "I\\XMX]W`VaTbQbOa RXPVNTMQMONMPLSLUMXOZQ[T[VZXX",
    "I\\MFM[ RMQPNRMUMWNXQX[", "NVQFRGSFREQF RRMR[", "MWRFSGTFSERF RSMS^RaPbNb", "IZMFM[ RWMMW RQSX[", "NVRFR[",
    "CaGMG[ RGQJNLMOMQNRQR[ RRQUNWMZM\\N]Q][", "I\\MMM[ RMQPNRMUMWNXQX[", "I\\QMONMPLSLUMXOZQ[T[VZXXYUYSXPVNTMQM",
    "H[LMLb RLPNNPMSMUNWPXSXUWXUZS[P[NZLX", "I\\XMXb RXPVNTMQMONMPLSLUMXOZQ[T[VZXX", "KXOMO[ ROSPPRNTMWM",
    "J[XPWNTMQMNNMPNRPSUTWUXWXXWZT[Q[NZMX", "MYRFRWSZU[W[ ROMVM", "I\\MMMWNZP[S[UZXW RXMX[", "JZLMR[ RXMR[",
    "G]JMN[ RRMN[ RRMV[ RZMV[", "J[MMX[ RXMM[", "JZLMR[ RXMR[P_NaLbKb", "J[XMM[ RMMXM RM[X[",
    "KYTBRCQDPFPHQJRKSMSOQQ RRCQEQGRISJTLTNSPORSTTVTXSZR[Q]Q_Ra RQSSUSWRYQZP\\P^Q`RaTb", "NVRBRb",
    "KYPBRCSDTFTHSJRKQMQOSQ RRCSESGRIQJPLPNQPURQTPVPXQZR[S]S_Ra RSSQUQWRYSZT\\T^S`RaPb",
    "F^IUISJPLONOPPTSVTXTZS[Q RISJQLPNPPQTTVUXUZT[Q[O",
];
